# cmake -DPROGRAM=... -DLIBRARIES=... -DREADELF=... -P needs_no.cmake
# Checks that PROGRAM is linked to no library whose name matches the expression LIBRARIES.
execute_process(COMMAND ${READELF} -d -W ${PROGRAM} OUTPUT_VARIABLE dynamic COMMAND_ERROR_IS_FATAL ANY)
if(dynamic MATCHES "NEEDED[^\n]*(${LIBRARIES})[^\n]*")
  message(SEND_ERROR "${PROGRAM}: ${CMAKE_MATCH_0}")
endif()
