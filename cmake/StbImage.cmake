# stb_image up to 2.27 writes beyond an array where a JPEG's Huffman table says that it has more than 256
# codes. Later ones look; Debian 12 has 2.27. The copy that is compiled looks, too: io/image_decode.cpp
# includes it in the header's place. Where the text is another one, the header is taken as it is.
set(RAYSHEAF_STB_IMAGE_DIR ${PROJECT_BINARY_DIR}/stb_image)
file(READ ${STB_INCLUDE_DIR}/stb/stb_image.h text)
string(REPLACE
  "      for (j=0; j < count[i]; ++j)\n         h->size[k++] = (stbi_uc) (i+1);\n"
  "      for (j=0; j < count[i]; ++j) {\n         if (k >= 256) return stbi__err(\"bad size list\",\"Corrupt JPEG\");\n         h->size[k++] = (stbi_uc) (i+1);\n      }\n"
  text "${text}")
file(CONFIGURE OUTPUT ${RAYSHEAF_STB_IMAGE_DIR}/stb/stb_image.h CONTENT "${text}" @ONLY)
