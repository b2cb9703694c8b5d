#include "font.h"

/* A glyph is 5 dots wide and 8 high: dot (x, y) is bit 5 * y + x. Space is the first. */
static const uint64_t glyphs[] = {
    0x0000000000, 0x0100421084, 0x000000294a, 0x0295f57d4a, 0x011f4717c4, 0x0672222273,
    0x0593511526, 0x0000001084, 0x0208210888, 0x0088842082, 0x0009575480, 0x00084f9080,
    0x1118000000, 0x00000f8000, 0x0318000000, 0x0042222210, 0x03a33ae62e, 0x03884210c4,
    0x07c444422e, 0x03e107420f, 0x0211f4a988, 0x03a3083c3f, 0x03a317842e, 0x010844221f,
    0x03a317462e, 0x03a10f462e, 0x0018c03180, 0x0088c03180, 0x0208208888, 0x0001f07c00,
    0x0088882082, 0x010044422e, 0x0382daf62e, 0x0463f8c544, 0x03e317c62f, 0x03a210862e,
    0x01d318c527, 0x07c217843f, 0x004217843f, 0x07a31c862e, 0x04631fc631, 0x038842108e,
    0x019284211c, 0x0452519531, 0x07c2108421, 0x04631ad771, 0x04739ace71, 0x03a318c62e,
    0x004217c62f, 0x059358c62e, 0x045257c62f, 0x03e107043e, 0x010842109f, 0x03a318c631,
    0x0114a8c631, 0x04775ac631, 0x0462a22a31, 0x0108422a31, 0x07c222221f, 0x038421084e,
    0x0420820821, 0x039084210e, 0x0000004544, 0x07c0000000, 0x0000000082, 0x07a3e83800,
    0x03e318bc21, 0x078210f800, 0x07a318fa10, 0x0783f8b800, 0x0084213c4c, 0x743d18f800,
    0x046318bc21, 0x0388421804, 0x3210843008, 0x024a32a421, 0x0388421086, 0x046b5aac00,
    0x046318bc00, 0x03a318b800, 0x085f18bc00, 0x843d18f800, 0x004211b400, 0x03e0e0f800,
    0x0304213c42, 0x07a318c400, 0x0114a8c400, 0x02ab5ac400, 0x0454454400, 0x743d18c400,
    0x07c4447c00, 0x030841108c, 0x0108421084, 0x0188441086, 0x000006c800};

static bool glyph_dot(char character, int x, int y) {
    const bool known = character >= ' ' && character <= '~';
    return glyphs[known ? character - ' ' : '?' - ' '] >> (5 * y + x) & 1;
}

static void fill_square(shb_image *image, int64_t left, int64_t top, uint32_t size,
                        const uint8_t color[3]) {
    const size_t stride = image->stride ? image->stride : 3 * (size_t)image->width;
    for (int64_t y = top; y < top + size; y++)
        for (int64_t x = left; x < left + size; x++) {
            if (x < 0 || y < 0 || x >= image->width || y >= image->height)
                continue;
            uint8_t *pixel = image->pixels + (size_t)y * stride + 3 * (size_t)x;
            for (int k = 0; k < 3; k++)
                pixel[k] = color[k];
        }
}

void font_draw(shb_image *image, int64_t x, int64_t y, uint32_t scale, const uint8_t color[3],
               const char *text) {
    for (; *text; text++, x += (int64_t)FONT_WIDTH * scale)
        for (int row = 0; row < 8; row++)
            for (int column = 0; column < 5; column++)
                if (glyph_dot(*text, column, row))
                    fill_square(image, x + (int64_t)column * scale, y + (int64_t)row * scale, scale,
                                color);
}
