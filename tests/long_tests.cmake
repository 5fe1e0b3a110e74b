# The tests that ./check leaves to ./check --analyze: each takes seconds of a core, and shows with more
# cases, with larger scenes or through other programs what shorter tests show, or it looks for faults
# that few changes make. They have the label `long`; a build without RAYSHEAF_LONG_TESTS has none of
# them. Rooms that are long as a whole: faults and random input, the laboratory, the stages of the
# published methods, whose hits tests/verify and tests/frame compare with exact ones, and the way of a
# ray, which compiles a part of the library again.
set(long_rooms faults fuzz lab packets ray_hierarchy way)
# In other rooms, a GoogleTest filter:
string(JOIN ":" long_api Memory.TenThousandScenesLeaveNothing)
string(JOIN ":" long_app All/LargerScenes.* Bench.ThePapersScenesCompareOnlyAtThePapersSize
  Errors.InterruptLeavesNothing Ranks.A* Ranks.Builtin* Ranks.MayWork* Ranks.OneFailure*
  Stopped.StoppedWritersLeaveNothing)
string(JOIN ":" long_device *.MemoryThatRunsOutAnywhere*)
string(JOIN ":" long_frame DeviceFrameMemory.* Groups.ComputedTwice* Scenes/*)
string(JOIN ":" long_house Documents.CommandsRun)
string(JOIN ":" long_out_of_core StreamOnLittleDevices.*)
string(JOIN ":" long_verify ExactQueries.E* ExactQueries.O* ExactQueries.S* Verify.EveryMutantIsFound)
string(JOIN ":" long_viewer WindowTest.DrawsThePreview* WindowTest.MeasuresHowLong* WindowTest.PicturesDiffer*
  WindowTest.StaysOpen* WindowTest.UserInput*)
# Files of tests/python:
set(long_python examples notebook process typing)
