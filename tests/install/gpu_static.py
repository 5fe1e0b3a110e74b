"""Tests the parsers of tools/gpu --static for nvcc and nvdisasm on a made-up listing and log."""
import os
import pathlib
import subprocess
import sys
import unittest

sys.dont_write_bytecode = True
TOOLS = pathlib.Path(__file__).resolve().parents[2] / "tools"
sys.path.insert(0, str(TOOLS / "gpu_counts"))
import kernels  # noqa: E402
import sass  # noqa: E402

# A tree traversal with one thread per item. A node has 64 bytes and a triangle 48. The path from
# the node through its first branch would be the shortest one back to .L_node, but the predicate
# that .L_back tests is true on it.
LISTING = """
\t.section\t.text._Zwalk,"ax",@progbits
\t.align\t128
_Zwalk:
.text._Zwalk:
        /*0000*/                   LDC R1, c[0x0][0x28] ;
        /*0010*/                   S2R R2, SR_TID.X ;
.L_item:
        /*0020*/               @P0 EXIT ;
        /*0030*/                   LDG.E.128 R4, desc[UR4][R2.64] ;
        /*0040*/                   CALL.REL.NOINC `($divide) ;
.L_node:
        /*0050*/                   BSSY B0, `(.L_back) ;
        /*0060*/                   ISETP.GE.AND P1, PT, R9, RZ, PT ;
        /*0070*/              @!P1 BRA `(.L_leaf) ;
.L_not_a_target:
        /*0080*/                   LDG.E.128 R12, desc[UR6][R2.64+0x20] ;
        /*0090*/                   LDL R28, [R1+0x8]  (*"SpillRefill"*);
        /*00a0*/                   LDG.E.128 R16, desc[UR6][R2.64+0x10] ;
        /*00b0*/                   LDG.E.128.CONSTANT R20, desc[UR6][R2.64] ;
.L_a_label_splits_nothing:
        /*00c0*/                   LDG.E.64 R24, desc[UR6][R2.64+0x30] ;
        /*00d0*/                   FSETP.GTU.AND P2, PT, R5, R20, PT ;
        /*00e0*/                   PLOP3.LUT P1, PT, PT, PT, PT, 0x80, 0x0 ;
        /*00f0*/              @!P2 STL.64 [R3+0x80], R6 ;
        /*0100*/              @!P2 BRA `(.L_back) ;
        /*0110*/                   SEL R9, R24, R25, P0 ;
        /*0120*/                   PLOP3.LUT P1, PT, PT, PT, PT, 0x8, 0x0 ;
        /*0130*/                   BRA `(.L_back) ;
.L_leaf:
        /*0140*/                   LDG.E.128 R12, desc[UR6][R2.64] ;
        /*0150*/                   LDG.E.128 R16, desc[UR6][R2.64+0x10] ;
        /*0160*/                   LDG.E.128 R20, desc[UR6][R2.64+0x20] ;
        /*0170*/               @P3 BRA `(.L_leaf) ;
        /*0180*/                   PLOP3.LUT P1, PT, PT, PT, PT, 0x80, 0x0 ;
.L_back:
        /*0190*/                   BSYNC B0 ;
        /*01a0*/              @!P1 BRA `(.L_node) ;
.L_pop:
        /*01b0*/                   LDL R9, [R3] ;
        /*01c0*/                   FSETP.GTU.AND P0, PT, R3, R4, PT ;
        /*01d0*/               @P0 BRA `(.L_pop) ;
        /*01e0*/                   ISETP.NE.AND P4, PT, R9, RZ, PT ;
        /*01f0*/                   BRA P4, `(.L_node) ;
        /*0200*/                   BRA `(.L_item) ;
$divide:
        /*0210*/                   MUFU.RCP R4, R5 ;
        /*0220*/                   RET.REL.NODEC R6 `(_Zwalk) ;
.L_trap:
        /*0230*/                   BRA `(.L_trap);
        /*0240*/                   NOP;
\t.section\t.text._Zadd,"ax",@progbits
.text._Zadd:
        /*0000*/                   LDG.E.U8 R4, desc[UR4][R2.64] ;
        /*0010*/                   STG.E desc[UR4][R2.64], R4 ;
        /*0020*/                   EXIT ;
.L_x_1:
        /*0030*/                   BRA `(.L_x_1);
"""

LOG = """ptxas info    : 0 bytes gmem
ptxas info    : Compiling entry function '_Zwalk' for 'sm_90'
ptxas info    : Function properties for _Zwalk
    512 bytes stack frame, 20 bytes spill stores, 24 bytes spill loads
ptxas info    : Used 72 registers, used 0 barriers, 1024 bytes cumulative stack size
ptxas info    : Compile time = 70.123 ms
ptxas info    : Function properties for _Zdivide
    0 bytes stack frame, 8 bytes spill stores, 4 bytes spill loads
ptxas info    : Compiling entry function '_Zadd' for 'sm_90'
ptxas info    : Function properties for _Zadd
    0 bytes stack frame, 0 bytes spill stores, 0 bytes spill loads
ptxas info    : Used 8 registers, used 0 barriers
"""


class Sass(unittest.TestCase):
    def setUp(self):
        self.functions = sass.functions(LISTING)

    def turn(self, name):
        return sass.inner_turn(sass.blocks_of(*self.functions[name]))

    def test_every_function_is_found(self):
        self.assertEqual(list(self.functions), ["_Zwalk", "_Zadd"])
        self.assertEqual([len(i) for i, _ in self.functions.values()], [37, 4])

    def test_the_turn_is_the_nodes_and_agrees_with_predicates(self):
        turn = self.turn("_Zwalk")
        # The node's 9 and 3, BSYNC and its branch, the loop's first 3. Without predicates it would
        # be 14.
        self.assertEqual(len(turn), 17)
        self.assertIn("SEL", [i.opcode for i in turn])
        self.assertEqual(sass.count(turn), sass.Turn(17, 4, 56, 2, 6))

    def test_a_call_that_is_a_jump(self):
        jump = """@P1 CALL.REL.NOINC `(.L_pop) ;
        /*01a8*/                   BRA `(.L_node) ;"""
        self.functions = sass.functions(LISTING.replace("@!P1 BRA `(.L_node) ;", jump))
        self.assertEqual(len(self.turn("_Zwalk")), 18)

    def test_nothing_in_a_loop_reads(self):
        self.assertIsNone(self.turn("_Zadd"))

    def test_branches(self):
        def branch(text):
            return sass.functions(f".text._Zf:\n        /*0000*/ {text} ;\n")["_Zf"][0][0]
        self.assertFalse(branch("BRA `(.L)").goes_on())
        self.assertFalse(branch("@!PT BRA `(.L)").conditions)
        self.assertEqual(branch("@P0 BRA P1, `(.L)").conditions, ["P0", "P1"])
        self.assertEqual(branch("BRA.U !UP1, `(.L)").conditions, ["!UP1"])
        self.assertTrue(branch("@P0 EXIT").goes_on())
        self.assertFalse(branch("EXIT").goes_on())
        self.assertTrue(branch("CALL.REL.NOINC `($f)").goes_on())
        self.assertIsNone(branch("CALL.REL.NOINC `($f)").target)
        self.assertEqual(branch("@P1 CALL.REL.NOINC `(.L_x_3)").target, ".L_x_3")
        self.assertEqual(branch("@P1 CALL.REL.NOINC `(.L_x_3)").conditions, ["P1"])
        self.assertEqual(branch("@!P0 BRA `(.L_x_7)").target, ".L_x_7")


class Kernels(unittest.TestCase):
    def test_resources_and_spills_of_called_functions(self):
        found = kernels.resources_of(LOG)
        self.assertEqual(found["_Zwalk"], kernels.Resources(72, 1024, 44, 12))
        self.assertEqual(found["_Zadd"], kernels.Resources(8, 0, 0, 0))

    def test_names(self):
        def name(inner):
            return kernels.short_name(f"void raysheaf::run_items<{inner}>(unsigned long, {inner})")
        device = "raysheaf::CudaDevice"
        any_hits = f"raysheaf::any_hits_on<{device}>({device}&, unsigned char*)::{{lambda(unsigned long)#1}}"
        build = f"raysheaf::LinearTree::build<{device}>({device}&)::{{lambda(unsigned long)#4}}"
        mark = f"raysheaf::DeviceEngineOn<{device}>::mark_found(raysheaf::View<int>)::{{lambda(unsigned long)#1}}"
        self.assertEqual(name(any_hits), "any_hits_on")
        self.assertEqual(name(build), "LinearTree::build 4")
        self.assertEqual(name(mark), "DeviceEngineOn::mark_found")
        self.assertEqual(kernels.short_name("void raysheaf::fill_words<int>(int*)"), "fill_words")

    def test_the_command_makes_a_cubin(self):
        given = ["nvcc", "-I", "a", "--generate-code=arch=compute_75,code=[compute_75,sm_75]", "-O2", "-x", "cu", "-c",
                 "k.cu", "-MD", "-MT", "k.o", "-MF", "k.d", "-o", "k.o"]
        self.assertEqual(kernels.cubin_command(given, "90", "k.cubin", "u.d"),
                         ["nvcc", "-I", "a", "-O2", "-x", "cu", "k.cu", "-cubin", "-arch=sm_90", "-Xptxas", "-v", "-MD",
                          "-MF", "u.d", "-o", "k.cubin"])

    def test_the_table(self):
        rows = kernels.rows("90", kernels.resources_of(LOG), LISTING, {"_Zwalk": "walk", "_Zadd": "add"})
        lines = kernels.table(rows + rows).splitlines()
        self.assertEqual(len(lines), 4, "a kernel of two sources is shown once")
        self.assertEqual(lines[2], "| `add` | 90 | 8 | 0 | 0 | 0 | 4 | – | – | – | – | – |")
        self.assertEqual(lines[3], "| `walk` | 90 | 72 | 1024 | 44 | 12 | 36 | 17 | 4 | 56 | 2 | 6 |")
        self.assertEqual({line.count("|") for line in lines}, {13})


class Tool(unittest.TestCase):
    def run_tool(self, *arguments, **variables):
        return subprocess.run([sys.executable, TOOLS / "gpu_static", *arguments], text=True, capture_output=True,
                              check=False, env={**os.environ, **variables})

    def test_architectures_are_numbers(self):
        done = self.run_tool("--arch", "hopper")
        self.assertEqual(done.returncode, 2)
        self.assertIn("--arch wants numbers such as 75,90, not 'hopper'", done.stderr)

    def test_patterns_are_checked(self):
        done = self.run_tool("--match", "(")
        self.assertEqual(done.returncode, 2)
        self.assertIn("--match: missing )", done.stderr)

    def test_a_missing_compiler_is_one_sentence(self):
        done = self.run_tool("--only", "kernels", PATH="/nowhere", CUDA_HOME="/nowhere")
        self.assertEqual((done.returncode, done.stdout), (3, ""))
        self.assertEqual(done.stderr, "tools/gpu --static: nvcc is neither on the PATH nor in CUDA_HOME/bin\n")

    def test_a_missing_program_is_named(self):
        done = self.run_tool("--only", "rays", "--raysheaf", "/nowhere/raysheaf")
        self.assertEqual((done.returncode, done.stdout), (3, ""))
        self.assertIn("/nowhere/raysheaf", done.stderr)


if __name__ == "__main__":
    unittest.main()
