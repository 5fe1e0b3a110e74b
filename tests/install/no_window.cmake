# Checks that PROGRAM runs without a window system: it must not be linked to one.
execute_process(COMMAND ${READELF} -d -W ${PROGRAM} OUTPUT_VARIABLE dynamic COMMAND_ERROR_IS_FATAL ANY)
if(dynamic MATCHES "NEEDED[^\n]*(glfw|X11|xcb|wayland)[^\n]*")
  message(SEND_ERROR "${PROGRAM}: ${CMAKE_MATCH_0}")
endif()
