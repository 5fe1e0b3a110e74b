# Up to version 2.27 (Debian 12), stb_image leaves missing entries of a BMP's palette uninitialised:
# a pixel that uses one would have another colour each time. The compiled copy sets them to black,
# and io/image_decode.cpp includes it instead of the header. If the header has a different text, it
# is used unchanged.
set(RAYSHEAF_STB_IMAGE_DIR ${PROJECT_BINARY_DIR}/stb_image)
file(READ ${STB_HEADER_DIR}/stb_image.h text)
string(REPLACE "   stbi_uc pal[256][4];\n   int psize" "   stbi_uc pal[256][4] = {{0}};\n   int psize" text "${text}")
file(CONFIGURE OUTPUT ${RAYSHEAF_STB_IMAGE_DIR}/stb_image.h CONTENT "${text}" @ONLY)
