/* Triangles as the light sees them, LIST_LANES at a time, each function with a bound of its
 * rounding.
 *
 * Bounds. Let d bound the rounding of a corner's and of a point's X and Y together, and L the sizes
 * of the triangle's box. Twice the area of the triangle is then known within 2 d L, and so is the
 * part of it that is a weight times the area at a point in or near the box. While the area is known
 * to a half, a weight is off by no more than 6 d L / area; and where the area is not known at all a
 * point inside has no weight below -6 d L / area either. Elements rounded to floats, and cells and
 * points that are asked in floats, add 2^-21 (1 + sum of sizes): X, Y, two products and sums each,
 * and the first weight is 1 less two others.
 *
 * The plane's distance at a point of weights b_k moves by sum b_k (dz + |slope x| dx + |slope y|
 * dy) with its corners and by as much with the point, as long as the area is known well. Rounding
 * of the slopes: the area carries its two products' sizes, hence `condition`. */

/* A bound in float, not below the value. */
#define ROUNDED_UP(value) ((float)((value) * (1 + 0x1p-22)))

static inline void gather_corners(const shb_list_vertex *vertices,
                                  const uint32_t *const corners[LIST_LANES],
                                  shb_list_corners *restrict out) {
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < LIST_LANES; i += DOUBLES) {
            const double *from[DOUBLES];
            wd seen[4];
            for (int lane = 0; lane < DOUBLES; lane++)
                from[lane] = &vertices[corners[i + lane][k]].x;
            wd_read_quads(from, seen);
            wd_store(out->x[k] + i, seen[0]);
            wd_store(out->y[k] + i, seen[1]);
            wd_store(out->z[k] + i, seen[2]);
            wd_store(out->inverse_w[k] + i, seen[3]);
        }
}

/* Lanes with a corner in front of the near plane or too near to the light's own. */
static uint32_t find_cut(const shb_list_frame *frame, const shb_list_corners *restrict c) {
    const wd least = wd_splat(0x1p-4 / frame->errors[3]), none = wd_splat(0);
    uint32_t cut = 0;
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < LIST_LANES; i += DOUBLES) {
            const wd inverse = wd_load(c->inverse_w[k] + i);
            const uint32_t whole = wd_greater_bits(inverse, none) & wd_greater_bits(least, inverse);
            cut |= (~whole & ((1u << DOUBLES) - 1)) << i;
        }
    return cut;
}

/* The results of prepare, lane by lane. */
typedef struct prepared {
    SHB_ALIGN double plane[3][LIST_LANES];
    float u[3][LIST_LANES], v[3][LIST_LANES], rest[LIST_LANES];
    float margin[LIST_LANES], bound[LIST_LANES], clear[LIST_LANES];
    uint64_t turned[LIST_LANES];  /* all bits where the area is negative */
    int32_t is_known[LIST_LANES]; /* of the outline */
    int32_t first_column[LIST_LANES], first_row[LIST_LANES];
    int32_t last_column[LIST_LANES], last_row[LIST_LANES], level[LIST_LANES];
} prepared;

/* Outward bounds of what a triangle's corners are off by. */
typedef struct list_spread {
    SHB_ALIGN double x[LIST_LANES];
    double y[LIST_LANES], z[LIST_LANES];
    double width[LIST_LANES], height[LIST_LANES]; /* of the box, and a texel */
    double inverse_w[LIST_LANES];                 /* the largest */
} list_spread;

static void bound_triangles(const shb_list_frame *frame, const shb_list_corners *restrict c,
                            list_spread *restrict spread, prepared *restrict out) {
    const double width = frame->width, height = frame->height, rim = frame->rim;
    const double *e = frame->errors;
    for (int i = 0; i < LIST_LANES; i++) {
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
        const double x = (e[0] + far_x * e[3]) * inverse, y = (e[1] + far_y * e[3]) * inverse;
        const double z = (e[2] + far_z * e[3]) * inverse;
        spread->inverse_w[i] = inverse;
        spread->x[i] = x;
        spread->y[i] = y;
        spread->z[i] = z;
        spread->width[i] = hi_x - lo_x + 1;
        spread->height[i] = hi_y - lo_y + 1;
        const double left = lo_x - (4 * x + rim), right = hi_x + (4 * x + rim);
        const double top = lo_y - (4 * y + rim), bottom = hi_y + (4 * y + rim);
        const int seen = (right >= 0) & (left <= width) & (bottom >= 0) & (top <= height);
        out->first_column[i] = (int32_t)double_min(double_max(left, 0), width - 1);
        out->last_column[i] = (int32_t)double_min(double_max(right, 0), width - 1);
        out->first_row[i] = seen ? (int32_t)double_min(double_max(top, 0), height - 1) : UINT16_MAX;
        out->last_row[i] = seen ? (int32_t)double_min(double_max(bottom, 0), height - 1) : 0;
        const double rounded = (frame->rounding_z + far_z * frame->rounding_w) * inverse;
        const double level = ((lo_z - 4 * z - rounded) - frame->level_origin) * frame->levels;
        out->level[i] = (int32_t)double_min(double_max(level, 0), SHB_LIST_LEVELS - 1);
    }
}

static void prepare_planes(const shb_list_frame *frame, const shb_list_corners *restrict c,
                           const list_spread *restrict spread, prepared *restrict out) {
    const double width = frame->width, height = frame->height, reach = frame->reach;
    double rows[4][3];
    memcpy(rows[0], frame->rows[0], sizeof rows[0]);
    memcpy(rows[1], frame->rows[1], sizeof rows[1]);
    memcpy(rows[2], frame->rows[2], sizeof rows[2]);
    memcpy(rows[3], frame->rows[3], sizeof rows[3]);
    for (int i = 0; i < LIST_LANES; i++) {
        const double x0 = c->x[0][i], y0 = c->y[0][i], z0 = c->z[0][i];
        const double x1 = c->x[1][i] - x0, y1 = c->y[1][i] - y0, z1 = c->z[1][i] - z0;
        const double x2 = c->x[2][i] - x0, y2 = c->y[2][i] - y0, z2 = c->z[2][i] - z0;
        const double area = x1 * y2 - x2 * y1, size = fabs(x1 * y2) + fabs(x2 * y1);
        const int flat = !(fabs(area) > 0x1p-64);
        const double inverse = flat ? 0x1p64 : 1 / area, scale = fabs(inverse);
        const double ux = y2 * inverse, uy = -x2 * inverse;
        const double vx = -y1 * inverse, vy = x1 * inverse;
        const double u_one = -(ux * x0 + uy * y0), v_one = -(vx * x0 + vy * y0);
        const double sizes = ((fabs(ux) + fabs(vx)) * width + (fabs(uy) + fabs(vy)) * height) +
                             (fabs(u_one) + fabs(v_one));
        const double off =
            (spread->x[i] + spread->y[i]) * (spread->width[i] + spread->height[i]) * scale;
        const double margin = 12 * off + 0x1p-21 * (1 + sizes) + (flat ? 2.0 : 0.0);
        const double slope_x = ux * z1 + vx * z2, slope_y = uy * z1 + vy * z2;
        const double condition = 1 + size * scale;
        const double rounding_x = (fabs(y2 * z1) + fabs(y1 * z2)) * scale * condition;
        const double rounding_y = (fabs(x2 * z1) + fabs(x1 * z2)) * scale * condition;
        const double moved =
            spread->z[i] + fabs(slope_x) * spread->x[i] + fabs(slope_y) * spread->y[i];
        const double evaluated = fabs(slope_x) * (width + fabs(x0)) +
                                 fabs(slope_y) * (height + fabs(y0)) + fabs(z0) + fabs(z1) +
                                 fabs(z2);
        const double rounding = rounding_x * spread->width[i] + rounding_y * spread->height[i];
        const double bound = (3 + 12 * margin) * moved + 0x1p-50 * (rounding + evaluated);
        const double one = z0 - (slope_x * x0 + slope_y * y0);
        double change = 0;
        for (int k = 0; k < 3; k++)
            change += fabs((rows[2][k] - slope_x * rows[0][k]) -
                           (slope_y * rows[1][k] + one * rows[3][k]));
        const double clear = bound + 0x1.01p-24 * change * reach * spread->inverse_w[i];
        const int known = (off < 0x1p-10) & !flat & (clear < 0x1p100);
        out->plane[0][i] = known ? -slope_x : 0.0;
        out->plane[1][i] = known ? -slope_y : 0.0;
        out->plane[2][i] = known ? -one : 0.0;
        out->bound[i] = known ? ROUNDED_UP(bound + SHB_LIST_LEAST_BOUND) : HUGE_VALF;
        out->clear[i] = known ? ROUNDED_UP(clear + SHB_LIST_LEAST_BOUND) : HUGE_VALF;
        const double steep = fabs(slope_x) + fabs(slope_y);
        out->is_known[i] = known & (margin < 0x1p-1) &
                           (spread->x[i] + spread->y[i] < SHB_LIST_CORNER) &
                           (steep * SHB_SIZE_MAX + fabs(one) < 0x1p100);
        out->turned[i] = area < 0 ? ~(uint64_t)0 : 0;
        const int usable = margin < 0x1p90;
        out->u[0][i] = usable ? (float)ux : 0.0f;
        out->u[1][i] = usable ? (float)uy : 0.0f;
        out->u[2][i] = usable ? (float)(u_one + margin) : 0.0f;
        out->v[0][i] = usable ? (float)vx : 0.0f;
        out->v[1][i] = usable ? (float)vy : 0.0f;
        out->v[2][i] = usable ? (float)(v_one + margin) : 0.0f;
        out->rest[i] = usable ? ROUNDED_UP(1 + 3 * margin) : HUGE_VALF;
        out->margin[i] = usable ? ROUNDED_UP(margin) : HUGE_VALF;
    }
}

/* Edges by the vertices at their ends, and the way in which they run round their triangles. */
typedef struct list_edges {
    SHB_ALIGN uint64_t names[3][LIST_LANES];
} list_edges;

static void name_edges(const uint64_t *names, const uint32_t *const corners[LIST_LANES],
                       const uint64_t turned[LIST_LANES], list_edges *restrict out) {
    SHB_ALIGN uint64_t ends[3][LIST_LANES];
    for (int i = 0; i < LIST_LANES; i++)
        for (int k = 0; k < 3; k++)
            ends[k][i] = names[corners[i][k]];
    for (int k = 0; k < 3; k++) {
        const uint64_t *restrict from = ends[(k + 1) % 3], *restrict to = ends[(k + 2) % 3];
        for (int i = 0; i < LIST_LANES; i++) {
            const uint64_t a = from[i], b = to[i], lower = a < b ? a : b, upper = a < b ? b : a;
            uint64_t name = (lower ^ (upper << 29 | upper >> 35)) * 0x9e3779b97f4a7c15u;
            name = (name ^ name >> 32) * 0xd6e8feb86659fd93u;
            name = a == b ? 0 : name ^ name >> 32;
            const uint64_t sign = (a < b ? 0 : ~(uint64_t)0) ^ turned[i];
            out->names[k][i] = (name ^ sign) + (sign & 0x100000001u);
        }
    }
}

static void put_outlines(const uint64_t *names, const uint32_t *const corners[LIST_LANES],
                         const shb_list_corners *restrict c, const prepared *made,
                         shb_list_outline *outlines) {
    list_edges edges;
    SHB_ALIGN float places[6][LIST_LANES];
    SHB_ALIGN uint32_t words[16][LIST_LANES];
    name_edges(names, corners, made->turned, &edges);
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < LIST_LANES; i++) {
            const int known = made->is_known[i];
            const int32_t column = k ? made->last_column[i] : made->first_column[i];
            const int32_t row = k ? made->last_row[i] : made->first_row[i];
            places[k][i] = known ? (float)c->x[k][i] : (float)column + 0.5f;
            places[3 + k][i] = known ? (float)c->y[k][i] : (float)row + 0.5f;
            words[6 + 2 * k][i] = (uint32_t)edges.names[k][i];
            words[7 + 2 * k][i] = (uint32_t)(edges.names[k][i] >> 32);
        }
    memcpy(words, places, sizeof places);
    memcpy(words[12], made->is_known, sizeof made->is_known);
    memset(words[13], 0, 3 * sizeof words[13]);
    for (int i = 0; i < LIST_LANES; i += WIDE)
        for (int w = 0; w < 16; w += 4) {
            vf four[4];
            for (int k = 0; k < 4; k++)
                memcpy(&four[k], words[w + k] + i, sizeof four[k]);
            vf_write_quads((char *)(outlines + i) + 4 * w, sizeof *outlines, four);
        }
}

/* The doubles that hold the bytes of two floats each. */
static inline wd pairs_of(const float *restrict first, const float *restrict second) {
    SHB_ALIGN float pairs[DOUBLES][2];
    wd out;
    for (int i = 0; i < DOUBLES; i++) {
        pairs[i][0] = first[i];
        pairs[i][1] = second[i];
    }
    memcpy(&out, pairs, sizeof out);
    return out;
}

static void put_records(const prepared *restrict made, shb_list_triangle *restrict triangles) {
    SHB_ALIGN double records[LIST_LANES][8];
    for (int i = 0; i < LIST_LANES; i += DOUBLES) {
        wd_store_quads(records[i], 8, wd_load(made->plane[0] + i), wd_load(made->plane[1] + i),
                       wd_load(made->plane[2] + i), pairs_of(made->u[0] + i, made->u[1] + i));
        wd_store_quads(records[i] + 4, 8, pairs_of(made->u[2] + i, made->v[0] + i),
                       pairs_of(made->v[1] + i, made->v[2] + i),
                       pairs_of(made->rest + i, made->margin + i),
                       pairs_of(made->bound + i, made->clear + i));
    }
    for (int i = 0; i < LIST_LANES; i++)
        memcpy(&triangles[i], records[i], sizeof records[i]);
}

static uint32_t prepare_triangles(const shb_list_frame *frame, const shb_list_vertex *vertices,
                                  const uint64_t *names, const uint32_t *const corners[LIST_LANES],
                                  shb_list_triangle triangles[LIST_LANES],
                                  shb_list_box boxes[LIST_LANES], uint16_t levels[LIST_LANES],
                                  shb_list_outline outlines[LIST_LANES]) {
    shb_list_corners c;
    list_spread spread;
    prepared made;
    gather_corners(vertices, corners, &c);
    bound_triangles(frame, &c, &spread, &made);
    prepare_planes(frame, &c, &spread, &made);
    put_records(&made, triangles);
    for (int i = 0; i < LIST_LANES; i++)
        boxes[i] = (shb_list_box){(uint16_t)made.first_column[i], (uint16_t)made.first_row[i],
                                  (uint16_t)made.last_column[i], (uint16_t)made.last_row[i]};
    for (int i = 0; i < LIST_LANES; i++)
        levels[i] = (uint16_t)made.level[i];
    if (names)
        put_outlines(names, corners, &c, &made, outlines);
    return find_cut(frame, &c);
}
