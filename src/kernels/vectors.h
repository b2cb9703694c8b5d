/* Vectors of WIDE floats or ints for the loops that read maps at scattered places. Arithmetic and
 * comparisons (0 or -1 in each lane) are the compiler's own; what it lacks follows. */
#ifndef SRC_KERNELS_VECTORS_H
#define SRC_KERNELS_VECTORS_H

typedef float vf __attribute__((vector_size(4 * WIDE)));
typedef int32_t vi __attribute__((vector_size(4 * WIDE)));
typedef uint32_t vu __attribute__((vector_size(4 * WIDE)));

static inline vf vf_splat(float value) {
    return value - (vf){0};
}
static inline vi vi_splat(int32_t value) {
    return value - (vi){0};
}
static inline vf vf_load(const float *p) {
    vf v;
    memcpy(&v, p, sizeof v);
    return v;
}
static inline vi vi_load(const int32_t *p) {
    vi v;
    memcpy(&v, p, sizeof v);
    return v;
}
static inline vu vu_load(const uint32_t *p) {
    vu v;
    memcpy(&v, p, sizeof v);
    return v;
}
static inline void vf_store(float *p, vf v) {
    memcpy(p, &v, sizeof v);
}
static inline void vi_store(int32_t *p, vi v) {
    memcpy(p, &v, sizeof v);
}
static inline void vu_store(uint32_t *p, vu v) {
    memcpy(p, &v, sizeof v);
}
static inline vf vf_where(vi mask, vf yes, vf no) {
    return (vf)((mask & (vi)yes) | (~mask & (vi)no));
}
/* 0, 1, 2, ... */
static inline vi vi_numbers(void) {
    static const int32_t numbers[16] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
    return vi_load(numbers);
}
static inline vf vf_abs(vf v) {
    return (vf)((vi)v & 0x7fffffff);
}
/* a where the mask is set, else 0. */
static inline vf vf_keep(vi mask, vf a) {
    return (vf)(mask & (vi)a);
}

#if WIDE >= 8
/* Single loads take a third of the time of a gather instruction (Zen 5). */
static inline __m256 gather_eight(const float *base, __m256i index) {
    const uint64_t a = (uint64_t)_mm256_extract_epi64(index, 0);
    const uint64_t b = (uint64_t)_mm256_extract_epi64(index, 1);
    const uint64_t c = (uint64_t)_mm256_extract_epi64(index, 2);
    const uint64_t d = (uint64_t)_mm256_extract_epi64(index, 3);
    return _mm256_setr_ps(base[(uint32_t)a], base[a >> 32], base[(uint32_t)b], base[b >> 32],
                          base[(uint32_t)c], base[c >> 32], base[(uint32_t)d], base[d >> 32]);
}
#endif

/* vf_sqrt: the square root.
 * vf_by_sign: negative where the sign bit is set.
 * vf_gather: the floats at these indices, which are not negative.
 * vf_min, vf_max: a < b ? a : b, a > b ? a : b. vf_least: of all lanes, none of them NaN.
 * vi_any: true if the mask is set in some lane.
 * vi_bits: bit i: the mask is set in lane i. */
#if WIDE == 16
static inline vf vf_min(vf a, vf b) {
    return _mm512_min_ps(a, b);
}
static inline vf vf_max(vf a, vf b) {
    return _mm512_max_ps(a, b);
}
static inline vf vf_sqrt(vf v) {
    return _mm512_sqrt_ps(v);
}
static inline vf vf_by_sign(vi sign, vf negative, vf other) {
    return _mm512_mask_blend_ps(_mm512_movepi32_mask((__m512i)sign), other, negative);
}
static inline float vf_least(vf v) {
    return _mm512_reduce_min_ps(v);
}
static inline bool vi_any(vi mask) {
    return _mm512_movepi32_mask((__m512i)mask) != 0;
}
static inline uint32_t vi_bits(vi mask) {
    return _mm512_movepi32_mask((__m512i)mask);
}
static inline vf vf_gather(const float *base, vi index) {
    const __m256 low = gather_eight(base, _mm512_castsi512_si256((__m512i)index));
    const __m256 high = gather_eight(base, _mm512_extracti64x4_epi64((__m512i)index, 1));
    return _mm512_insertf32x8(_mm512_castps256_ps512(low), high, 1);
}
#elif WIDE == 8
static inline vf vf_min(vf a, vf b) {
    return _mm256_min_ps(a, b);
}
static inline vf vf_max(vf a, vf b) {
    return _mm256_max_ps(a, b);
}
static inline vf vf_sqrt(vf v) {
    return _mm256_sqrt_ps(v);
}
static inline vf vf_by_sign(vi sign, vf negative, vf other) {
    return _mm256_blendv_ps(other, negative, (__m256)sign);
}
static inline float vf_least(vf v) {
    const __m128 half = _mm_min_ps(_mm256_castps256_ps128(v), _mm256_extractf128_ps(v, 1));
    const __m128 two = _mm_min_ps(half, _mm_movehl_ps(half, half));
    return _mm_cvtss_f32(_mm_min_ss(two, _mm_movehdup_ps(two)));
}
static inline bool vi_any(vi mask) {
    return _mm256_movemask_ps((__m256)mask) != 0;
}
static inline uint32_t vi_bits(vi mask) {
    return (uint32_t)_mm256_movemask_ps((__m256)mask);
}
static inline vf vf_gather(const float *base, vi index) {
    return gather_eight(base, (__m256i)index);
}
#else
#if defined(__x86_64__) && WIDE == 4
static inline vf vf_min(vf a, vf b) {
    return _mm_min_ps(a, b);
}
static inline vf vf_max(vf a, vf b) {
    return _mm_max_ps(a, b);
}
static inline vf vf_sqrt(vf v) {
    return _mm_sqrt_ps(v);
}
static inline uint32_t vi_bits(vi mask) {
    return (uint32_t)_mm_movemask_ps((__m128)mask);
}
#else
static inline uint32_t vi_bits(vi mask) {
    uint32_t bits = 0;
    for (int i = 0; i < WIDE; i++)
        bits |= (uint32_t)(mask[i] & 1) << i;
    return bits;
}
static inline vf vf_min(vf a, vf b) {
    return vf_where(a < b, a, b);
}
static inline vf vf_max(vf a, vf b) {
    return vf_where(a > b, a, b);
}
static inline vf vf_sqrt(vf v) {
    for (int i = 0; i < WIDE; i++)
        v[i] = sqrtf(v[i]);
    return v;
}
#endif
static inline vf vf_by_sign(vi sign, vf negative, vf other) {
    return vf_where(sign < 0, negative, other);
}
static inline float vf_least(vf v) {
    float least = v[0];
    for (int i = 1; i < WIDE; i++)
        least = v[i] < least ? v[i] : least;
    return least;
}
static inline bool vi_any(vi mask) {
    int32_t any = 0;
    for (int i = 0; i < WIDE; i++)
        any |= mask[i];
    return any != 0;
}
static inline vf vf_gather(const float *base, vi index) {
    vf v;
    for (int i = 0; i < WIDE; i++)
        v[i] = base[index[i]];
    return v;
}
#endif

/* Products of numbers below 2^15. */
static inline vu vu_times_short(vu a, uint32_t b) {
#if defined(__x86_64__) && WIDE == 4
    return (vu)_mm_madd_epi16((__m128i)a, _mm_set1_epi32((int32_t)b));
#else
    return a * b;
#endif
}

/* The floats at indices that lie in memory, which spares taking a vector of them apart. */
static inline vf vf_read(const float *base, const uint32_t *indices) {
    vf v;
#if WIDE == 16
    /* Of sixteen single ones compilers make a broadcast with a mask each. */
    __m128 four[4];
    for (int i = 0; i < 4; i++)
        four[i] = _mm_setr_ps(base[indices[4 * i]], base[indices[4 * i + 1]],
                              base[indices[4 * i + 2]], base[indices[4 * i + 3]]);
    const __m256 low = _mm256_set_m128(four[1], four[0]), high = _mm256_set_m128(four[3], four[2]);
    v = _mm512_insertf32x8(_mm512_castps256_ps512(low), high, 1);
#else
    for (int i = 0; i < WIDE; i++)
        v[i] = base[indices[i]];
#endif
    return v;
}

/* vf_read_triples: WIDE triples without gaps, the first floats into out[0] and so on.
 * vf_read_quads: four floats from each place on, the first ones into out[0] and so on.
 * vf_write_quads: the reverse, a stride in bytes from one quad to the next. */
#if defined(__x86_64__) && WIDE >= 4
#if WIDE == 16
#define UNPACK(part, a, b) _mm512_unpack##part##_ps(a, b)
#define SHUFFLE(a, b, order) _mm512_shuffle_ps(a, b, order)
#elif WIDE == 8
#define UNPACK(part, a, b) _mm256_unpack##part##_ps(a, b)
#define SHUFFLE(a, b, order) _mm256_shuffle_ps(a, b, order)
#else
#define UNPACK(part, a, b) _mm_unpack##part##_ps(a, b)
#define SHUFFLE(a, b, order) _mm_shuffle_ps(a, b, order)
#endif
/* Four floats from every twelfth one on. */
static inline vf read_each_twelfth(const float *p) {
    const __m128 first = _mm_loadu_ps(p);
#if WIDE == 16
    const vf two = _mm512_insertf32x4(_mm512_castps128_ps512(first), _mm_loadu_ps(p + 12), 1);
    const vf three = _mm512_insertf32x4(two, _mm_loadu_ps(p + 24), 2);
    return _mm512_insertf32x4(three, _mm_loadu_ps(p + 36), 3);
#elif WIDE == 8
    return _mm256_insertf128_ps(_mm256_castps128_ps256(first), _mm_loadu_ps(p + 12), 1);
#else
    return first;
#endif
}
/* Rows of 4 x 4 floats to columns, in each 128 bits. */
static inline void turn_quads(const vf in[4], vf out[4]) {
    const vf a = UNPACK(lo, in[0], in[1]), b = UNPACK(hi, in[0], in[1]);
    const vf c = UNPACK(lo, in[2], in[3]), d = UNPACK(hi, in[2], in[3]);
    out[0] = SHUFFLE(a, c, _MM_SHUFFLE(1, 0, 1, 0));
    out[1] = SHUFFLE(a, c, _MM_SHUFFLE(3, 2, 3, 2));
    out[2] = SHUFFLE(b, d, _MM_SHUFFLE(1, 0, 1, 0));
    out[3] = SHUFFLE(b, d, _MM_SHUFFLE(3, 2, 3, 2));
}
/* Four triples in each 128 bits: x y z x, y z x y and z x y z. */
static inline void vf_read_triples(const float *triples, vf out[3]) {
    const vf a = read_each_twelfth(triples), b = read_each_twelfth(triples + 4);
    const vf c = read_each_twelfth(triples + 8);
    const vf yz = SHUFFLE(a, b, _MM_SHUFFLE(1, 0, 2, 1));
    const vf xy = SHUFFLE(b, c, _MM_SHUFFLE(2, 1, 3, 2));
    out[0] = SHUFFLE(a, xy, _MM_SHUFFLE(2, 0, 3, 0));
    out[1] = SHUFFLE(yz, xy, _MM_SHUFFLE(3, 1, 2, 0));
    out[2] = SHUFFLE(yz, c, _MM_SHUFFLE(3, 0, 3, 1));
}
#undef UNPACK
#undef SHUFFLE
/* The quads of lanes i, i + 4, i + 8, ... */
static inline vf read_every_fourth(const float *base, vu begin, int i) {
    const __m128 first = _mm_loadu_ps(base + begin[i]);
#if WIDE == 16
    const vf one = _mm512_castps128_ps512(first);
    const vf two = _mm512_insertf32x4(one, _mm_loadu_ps(base + begin[i + 4]), 1);
    const vf three = _mm512_insertf32x4(two, _mm_loadu_ps(base + begin[i + 8]), 2);
    return _mm512_insertf32x4(three, _mm_loadu_ps(base + begin[i + 12]), 3);
#elif WIDE == 8
    const vf one = _mm256_castps128_ps256(first);
    return _mm256_insertf128_ps(one, _mm_loadu_ps(base + begin[i + 4]), 1);
#else
    return first;
#endif
}
static inline void vf_read_quads(const float *base, vu begin, vf out[4]) {
    const vf rows[4] = {read_every_fourth(base, begin, 0), read_every_fourth(base, begin, 1),
                        read_every_fourth(base, begin, 2), read_every_fourth(base, begin, 3)};
    turn_quads(rows, out);
}
static inline void vf_write_quads(void *to, size_t stride, const vf in[4]) {
    vf columns[4];
    turn_quads(in, columns);
    for (size_t i = 0; i < 4; i++)
        for (size_t part = 0; part < WIDE / 4; part++)
            memcpy((char *)to + (4 * part + i) * stride, (const char *)&columns[i] + 16 * part, 16);
}
#else
static inline void vf_read_triples(const float *triples, vf out[3]) {
    for (int i = 0; i < WIDE; i++)
        for (int k = 0; k < 3; k++)
            out[k][i] = triples[3 * i + k];
}
static inline void vf_read_quads(const float *base, vu begin, vf out[4]) {
    typedef float word __attribute__((may_alias));
    const word *const words = base; /* which may be no floats */
    for (uint32_t k = 0; k < 4; k++) {
        vf numbers = {0};
        for (int i = 0; i < WIDE; i++)
            numbers[i] = words[begin[i] + k];
        out[k] = numbers;
    }
}
static inline void vf_write_quads(void *to, size_t stride, const vf in[4]) {
    for (size_t i = 0; i < WIDE; i++) {
        const float lane[4] = {in[0][i], in[1][i], in[2][i], in[3][i]};
        memcpy((char *)to + i * stride, lane, sizeof lane);
    }
}
#endif

/* WIDE numbers from lane i on of a square of four by four, whose rows are a stride apart. */
#if WIDE == 16
static inline vf vf_load_square(const float *at, size_t stride, int i) {
    (void)i;
    const __m512 one = _mm512_castps128_ps512(_mm_loadu_ps(at));
    const __m512 two = _mm512_insertf32x4(one, _mm_loadu_ps(at + stride), 1);
    const __m512 three = _mm512_insertf32x4(two, _mm_loadu_ps(at + 2 * stride), 2);
    return _mm512_insertf32x4(three, _mm_loadu_ps(at + 3 * stride), 3);
}
static inline void vf_store_square(float *at, size_t stride, int i, vf v) {
    (void)i;
    _mm_storeu_ps(at, _mm512_castps512_ps128(v));
    _mm_storeu_ps(at + stride, _mm512_extractf32x4_ps(v, 1));
    _mm_storeu_ps(at + 2 * stride, _mm512_extractf32x4_ps(v, 2));
    _mm_storeu_ps(at + 3 * stride, _mm512_extractf32x4_ps(v, 3));
}
#elif WIDE == 8
static inline vf vf_load_square(const float *at, size_t stride, int i) {
    const float *from = at + (size_t)(i / 4) * stride;
    return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(from)),
                                _mm_loadu_ps(from + stride), 1);
}
static inline void vf_store_square(float *at, size_t stride, int i, vf v) {
    float *to = at + (size_t)(i / 4) * stride;
    _mm_storeu_ps(to, _mm256_castps256_ps128(v));
    _mm_storeu_ps(to + stride, _mm256_extractf128_ps(v, 1));
}
#else
static inline vf vf_load_square(const float *at, size_t stride, int i) {
    return vf_load(at + (size_t)(i / 4) * stride + i % 4);
}
static inline void vf_store_square(float *at, size_t stride, int i, vf v) {
    vf_store(at + (size_t)(i / 4) * stride + i % 4, v);
}
#endif

/* The lower three bytes of each word; up to 13 bytes behind them are overwritten. */
static inline void store_lower_triples(size_t count, const uint32_t *words, uint8_t *bytes) {
#if WIDE >= 8
    const __m128i order = _mm_setr_epi8(0, 1, 2, 4, 5, 6, 8, 9, 10, 12, 13, 14, -1, -1, -1, -1);
    for (size_t i = 0; i < count; i += 4) {
        const __m128i four = _mm_loadu_si128((const __m128i *)(const void *)(words + i));
        _mm_storeu_si128((__m128i *)(void *)(bytes + 3 * i), _mm_shuffle_epi8(four, order));
    }
#else
    for (size_t i = 0; i < count; i++)
        memcpy(bytes + 3 * i, words + i, sizeof *words);
#endif
}

#endif
