# stb_image up to 2.27 leaves the entries that a BMP's palette lacks as the stack was: a pixel that names
# one would be another colour each time. Debian 12 has 2.27. The copy that is compiled has them black:
# io/image_decode.cpp includes it in the header's place. Where the text is another one, the header is taken
# as it is.
set(RAYSHEAF_STB_IMAGE_DIR ${PROJECT_BINARY_DIR}/stb_image)
file(READ ${STB_HEADER_DIR}/stb_image.h text)
string(REPLACE "   stbi_uc pal[256][4];\n   int psize" "   stbi_uc pal[256][4] = {{0}};\n   int psize" text "${text}")
file(CONFIGURE OUTPUT ${RAYSHEAF_STB_IMAGE_DIR}/stb_image.h CONTENT "${text}" @ONLY)
