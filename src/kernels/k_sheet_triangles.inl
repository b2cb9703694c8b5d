/* Triangles of sheets: their boxes and facing, and their edges and depths as functions over a tile.
 *
 * Bounds. Let q bound the rounding of a corner's X and Y together, L the sizes of the triangle's
 * box. Twice its area is known within 2 q L; four times that tells which way it faces. An edge
 * function is divided by |dx| + |dy| of the edge, so that from the centre of a square of side 1 + 2
 * m to its corners it changes by 1/2 + m at most. It is off by q, and where the edge is short by
 * 4 q L / (|dx| + |dy|) at places of the box; evaluated in floats at coordinates up to a tile's
 * side, of values below that side where they matter, by less than 2^-15 more: INNER.
 *
 * Depth. The plane through three corners, each off by dz + |slope x| dx + |slope y| dy, is off by
 * three times that at places of the triangle, whose weights are 0 .. 1. A triangle whose area is
 * too small for slopes has its corners' depths. A point on it is rounded to floats: its depth is
 * off by (rounding z w + |Z| rounding w) / w, w at least that of one of the corners. */

#define SHEET_INNER 0x1p-13

/* Where triangles are counted, from a texel's centre: where no edge passes by because a mesh and
 * the map are aligned. */
#define ASIDE_X 0x1.9p-5
#define ASIDE_Y -0x1.3p-4

/* Bounds of what a triangle's corners are off by. */
typedef struct sheet_spread {
    SHB_ALIGN double x[SHEET_LANES];
    double y[SHEET_LANES], z[SHEET_LANES];
    double width[SHEET_LANES], height[SHEET_LANES]; /* of the box */
    double lo_x[SHEET_LANES], lo_y[SHEET_LANES], hi_x[SHEET_LANES], hi_y[SHEET_LANES];
    double lo_z[SHEET_LANES], hi_z[SHEET_LANES];
    double inverse_w[SHEET_LANES]; /* the largest */
} sheet_spread;

static void bound_corners(const shb_list_frame *frame, const shb_list_corners *restrict c,
                          sheet_spread *restrict out) {
    const double width = frame->width, height = frame->height;
    const double *e = frame->errors;
    for (int i = 0; i < SHEET_LANES; i++) {
        const double inverse =
            double_max(double_max(c->inverse_w[0][i], c->inverse_w[1][i]), c->inverse_w[2][i]);
        const double lo_x = double_min(double_min(c->x[0][i], c->x[1][i]), c->x[2][i]);
        const double hi_x = double_max(double_max(c->x[0][i], c->x[1][i]), c->x[2][i]);
        const double lo_y = double_min(double_min(c->y[0][i], c->y[1][i]), c->y[2][i]);
        const double hi_y = double_max(double_max(c->y[0][i], c->y[1][i]), c->y[2][i]);
        const double lo_z = double_min(double_min(c->z[0][i], c->z[1][i]), c->z[2][i]);
        const double hi_z = double_max(double_max(c->z[0][i], c->z[1][i]), c->z[2][i]);
        const double far_x = double_max(double_max(-lo_x, hi_x), width);
        const double far_y = double_max(double_max(-lo_y, hi_y), height);
        const double far_z = double_max(-lo_z, hi_z);
        out->inverse_w[i] = inverse;
        out->x[i] = (e[0] + far_x * e[3]) * inverse;
        out->y[i] = (e[1] + far_y * e[3]) * inverse;
        out->z[i] = (e[2] + far_z * e[3]) * inverse;
        out->width[i] = hi_x - lo_x;
        out->height[i] = hi_y - lo_y;
        out->lo_x[i] = lo_x;
        out->lo_y[i] = lo_y;
        out->hi_x[i] = hi_x;
        out->hi_y[i] = hi_y;
        out->lo_z[i] = lo_z;
        out->hi_z[i] = hi_z;
    }
}

/* Twice the area, and 0 where its sign is not known. */
static inline double sheet_area(double x1, double y1, double x2, double y2, double off,
                                double size) {
    const double area = x1 * y2 - x2 * y1;
    return fabs(area) > 8 * off * size ? area : 0.0;
}

/* Boxes reach one texel beyond a triangle, which is more than any margin. */
static void look_at_triangles(const shb_list_frame *frame, const shb_list_corners *corners,
                              shb_light_box boxes[SHEET_LANES], int8_t facing[SHEET_LANES]) {
    const double width = frame->width, height = frame->height;
    const shb_list_corners *restrict c = corners;
    sheet_spread spread;
    SHB_ALIGN int32_t left[SHEET_LANES], top[SHEET_LANES], right[SHEET_LANES], bottom[SHEET_LANES];
    int32_t sign[SHEET_LANES];
    float nearest[SHEET_LANES];
    bound_corners(frame, c, &spread);
    for (int i = 0; i < SHEET_LANES; i++) {
        const double x = 1 + 4 * spread.x[i], y = 1 + 4 * spread.y[i];
        const double lo_x = spread.lo_x[i] - x, hi_x = spread.hi_x[i] + x;
        const double lo_y = spread.lo_y[i] - y, hi_y = spread.hi_y[i] + y;
        const int seen = (hi_x >= 0) & (lo_x <= width) & (hi_y >= 0) & (lo_y <= height);
        left[i] = (int32_t)double_min(double_max(lo_x, 0), width - 1);
        right[i] = (int32_t)double_min(double_max(hi_x, 0), width - 1);
        top[i] = seen ? (int32_t)double_min(double_max(lo_y, 0), height - 1) : 1;
        bottom[i] = seen ? (int32_t)double_min(double_max(hi_y, 0), height - 1) : 0;
        const double z = spread.lo_z[i];
        nearest[i] = (float)(z - 0x1p-20 * (fabs(z) + 0x1p-100));
        const double area = sheet_area(
            c->x[1][i] - c->x[0][i], c->y[1][i] - c->y[0][i], c->x[2][i] - c->x[0][i],
            c->y[2][i] - c->y[0][i], spread.x[i] + spread.y[i], spread.width[i] + spread.height[i]);
        sign[i] = (area > 0) - (area < 0);
    }
    for (int i = 0; i < SHEET_LANES; i++) {
        boxes[i].box = (shb_list_box){(uint16_t)left[i], (uint16_t)top[i], (uint16_t)right[i],
                                      (uint16_t)bottom[i]};
        boxes[i].nearest = nearest[i];
        facing[i] = (int8_t)sign[i];
    }
}

/* Triangles as functions over a tile, counted from the centre of its first texel. */
typedef struct sheet_triangles {
    SHB_ALIGN float x[3][SHEET_LANES];
    float y[3][SHEET_LANES], one[3][SHEET_LANES]; /* edges, not negative inside */
    float touch[SHEET_LANES]; /* the triangle touches a texel only where no edge is below -touch */
    float aside[3][SHEET_LANES]; /* what edges have more at the point that is counted at */
    float inner[SHEET_LANES];    /* it covers that point only where no edge is below -inner there */
    float end[3][SHEET_LANES];   /* an edge with nothing beyond it is in a texel only where its
                                    function is not above this, nor below minus this */
    float slope_x[SHEET_LANES], slope_y[SHEET_LANES], depth[SHEET_LANES];
    float rise[SHEET_LANES]; /* more than the depth changes from a texel's centre on */
    float lo[SHEET_LANES], hi[SHEET_LANES]; /* bounds of the depth */
    int32_t left[SHEET_LANES], top[SHEET_LANES], right[SHEET_LANES], bottom[SHEET_LANES];
} sheet_triangles;

/* Boxes in the tile. */
static void put_boxes(const shb_sheet_tile *tile, const sheet_spread *restrict spread,
                      sheet_triangles *restrict t) {
    const double last_column = tile->columns - 1, last_row = tile->rows - 1;
    for (int i = 0; i < SHEET_LANES; i++) {
        const double x = 1 + 4 * spread->x[i], y = 1 + 4 * spread->y[i];
        const double lo_x = spread->lo_x[i] - x - tile->column;
        const double hi_x = spread->hi_x[i] + x - tile->column;
        const double lo_y = spread->lo_y[i] - y - tile->row;
        const double hi_y = spread->hi_y[i] + y - tile->row;
        t->left[i] = (int32_t)double_max(double_min(lo_x, last_column + 1), 0);
        t->top[i] = (int32_t)double_max(double_min(lo_y, last_row + 1), 0);
        t->right[i] = (int32_t)double_min(double_max(hi_x, -1), last_column);
        t->bottom[i] = (int32_t)double_min(double_max(hi_y, -1), last_row);
    }
}

/* The edge from corner k to the next. sign: of the area. */
static void put_edges(const shb_sheet_tile *tile, const shb_list_corners *restrict c, int k,
                      const double *restrict sign, const uint32_t *restrict ends,
                      double *restrict shortest, sheet_triangles *restrict t) {
    const double origin_x = tile->column + 0.5, origin_y = tile->row + 0.5;
    const int next = (k + 1) % 3;
    for (int i = 0; i < SHEET_LANES; i++) {
        const double ax = c->x[k][i] - origin_x, ay = c->y[k][i] - origin_y;
        const double dx = c->x[next][i] - c->x[k][i], dy = c->y[next][i] - c->y[k][i];
        const double length = fabs(dx) + fabs(dy);
        const double scale = length > 0 ? sign[i] / length : 0;
        t->x[k][i] = (float)(-dy * scale);
        t->y[k][i] = (float)(dx * scale);
        t->one[k][i] = (float)(dy * scale * ax - dx * scale * ay);
        t->aside[k][i] = (float)((dx * ASIDE_Y - dy * ASIDE_X) * scale);
        t->end[k][i] = ends[i] >> k & 1 ? 1.0f : 0.0f;
        shortest[i] = double_min(shortest[i], length);
    }
}

/* Where the area is not known, the triangle lies within a strip along its longest edge: that edge
 * takes the place of all three, from both sides, and none of it is of use. */
static void put_strip(const shb_sheet_tile *tile, const shb_list_corners *c, int i,
                      double *shortest, sheet_triangles *t) {
    int longest = 0;
    double length = -1;
    for (int k = 0; k < 3; k++) {
        const int next = (k + 1) % 3;
        const double size = fabs(c->x[next][i] - c->x[k][i]) + fabs(c->y[next][i] - c->y[k][i]);
        longest = size > length ? k : longest;
        length = size > length ? size : length;
    }
    const int next = (longest + 1) % 3;
    const double scale = length > 0 ? 1 / length : 0;
    const double x = -(c->y[next][i] - c->y[longest][i]) * scale;
    const double y = (c->x[next][i] - c->x[longest][i]) * scale;
    const double one =
        -(x * (c->x[longest][i] - tile->column - 0.5) + y * (c->y[longest][i] - tile->row - 0.5));
    for (int k = 0; k < 3; k++) {
        const float side = k == 1 ? -1.0f : k == 2 ? 0.0f : 1.0f;
        t->x[k][i] = side * (float)x;
        t->y[k][i] = side * (float)y;
        t->one[k][i] = k == 2 ? 0.0f : side * (float)one;
        t->aside[k][i] = 0;
        t->end[k][i] = 1.0f;
    }
    shortest[i] = length;
}

static void put_margins(const shb_sheet_frame *frame, const sheet_spread *restrict spread,
                        const double *restrict shortest, sheet_triangles *restrict t) {
    for (int i = 0; i < SHEET_LANES; i++) {
        const double q = spread->x[i] + spread->y[i];
        const double size = spread->width[i] + spread->height[i] + 4;
        const double off = q > 0 ? 4 * q + 16 * q * size / shortest[i] : 0;
        const double inner = SHEET_INNER + off, touch = 0.5 + frame->margin + 2 * inner;
        t->inner[i] = (float)inner;
        t->touch[i] = (float)touch;
        for (int k = 0; k < 3; k++)
            t->end[k][i] = t->end[k][i] > 0 ? (float)touch : -1.0f;
    }
}

static void put_depths(const shb_sheet_tile *tile, const shb_list_corners *restrict c,
                       const sheet_spread *restrict spread, const double *restrict areas,
                       sheet_triangles *restrict t) {
    const shb_sheet_frame *frame = tile->frame;
    const double origin_x = tile->column + 0.5, origin_y = tile->row + 0.5;
    const double half = 0.5 + frame->margin;
    const double rounding_z = frame->list.rounding_z, rounding_w = frame->list.rounding_w;
    for (int i = 0; i < SHEET_LANES; i++) {
        const double x0 = c->x[0][i], y0 = c->y[0][i], z0 = c->z[0][i];
        const double x1 = c->x[1][i] - x0, y1 = c->y[1][i] - y0, z1 = c->z[1][i] - z0;
        const double x2 = c->x[2][i] - x0, y2 = c->y[2][i] - y0, z2 = c->z[2][i] - z0;
        const double size = fabs(x1 * y2) + fabs(x2 * y1);
        const int flat = !(fabs(areas[i]) > 0x1p-24 * size);
        const double inverse = flat ? 0.0 : 1 / areas[i];
        const double slope_x = (y2 * z1 - y1 * z2) * inverse;
        const double slope_y = (x1 * z2 - x2 * z1) * inverse;
        const double depth = z0 - slope_x * (x0 - origin_x) - slope_y * (y0 - origin_y);
        const double steep = fabs(slope_x) + fabs(slope_y);
        const double far_z = double_max(fabs(spread->lo_z[i]), fabs(spread->hi_z[i]));
        const double point = (rounding_z + far_z * rounding_w) * spread->inverse_w[i];
        const double corner =
            3 * (spread->z[i] + fabs(slope_x) * spread->x[i] + fabs(slope_y) * spread->y[i]);
        const double off = 2 * (point + corner) + 0x1p-22 * far_z;
        const double evaluated = 0x1p-21 * (fabs(depth) + 2 * SHB_SHEET_TILE * steep);
        t->slope_x[i] = (float)slope_x;
        t->slope_y[i] = (float)slope_y;
        t->depth[i] = (float)depth;
        t->rise[i] = flat ? HUGE_VALF : (float)(steep * half + off + evaluated);
        t->lo[i] = (float)(spread->lo_z[i] - off);
        t->hi[i] = (float)(spread->hi_z[i] + off);
    }
}

static void put_triangles(const shb_sheet_tile *tile, const shb_list_corners *corners,
                          const uint32_t ends[SHEET_LANES], sheet_triangles *t) {
    const shb_list_corners *restrict c = corners;
    sheet_spread spread;
    SHB_ALIGN double areas[SHEET_LANES], sign[SHEET_LANES], shortest[SHEET_LANES];
    bound_corners(&tile->frame->list, c, &spread);
    for (int i = 0; i < SHEET_LANES; i++) {
        areas[i] = sheet_area(c->x[1][i] - c->x[0][i], c->y[1][i] - c->y[0][i],
                              c->x[2][i] - c->x[0][i], c->y[2][i] - c->y[0][i],
                              spread.x[i] + spread.y[i], spread.width[i] + spread.height[i]);
        sign[i] = areas[i] < 0 ? -1.0 : 1.0;
        shortest[i] = DBL_MAX;
    }
    put_boxes(tile, &spread, t);
    for (int k = 0; k < 3; k++)
        put_edges(tile, c, k, sign, ends, shortest, t);
    for (int i = 0; i < SHEET_LANES; i++)
        if (areas[i] == 0)
            put_strip(tile, c, i, shortest, t);
    put_margins(tile->frame, &spread, shortest, t);
    put_depths(tile, c, &spread, areas, t);
}
