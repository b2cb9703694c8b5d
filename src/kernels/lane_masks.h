/* Masks of WIDE lanes: single bits where the processor has them for vectors, otherwise 0 or -1 in
 * each lane. The including file has included vectors.h. */
#ifndef SRC_KERNELS_LANE_MASKS_H
#define SRC_KERNELS_LANE_MASKS_H

/* vm_not_above: a <= b. vm_less: a < b. vm_below: the same where the mask is set. vm_equal: the
 * same for a == b. vm_clear: where the mask is set and v has none of the bits. vm_without: a, but
 * not b. vf_pick, vm_add, vm_keep: yes, the sum, or v, where the mask is set; else no, a, or 0. */
#if WIDE == 16
typedef __mmask16 vm;
static inline vm vm_not_above(vf a, vf b) {
    return _mm512_cmp_ps_mask(a, b, _CMP_LE_OQ);
}
static inline vm vm_below(vm mask, vf a, vf b) {
    return _mm512_mask_cmp_ps_mask(mask, a, b, _CMP_LT_OQ);
}
static inline vm vm_equal(vm mask, vi a, vi b) {
    return _mm512_mask_cmpeq_epi32_mask(mask, (__m512i)a, (__m512i)b);
}
static inline vf vf_pick(vm mask, vf yes, vf no) {
    return _mm512_mask_blend_ps(mask, no, yes);
}
static inline vi vi_pick(vm mask, vi yes, vi no) {
    return (vi)_mm512_mask_blend_epi32(mask, (__m512i)no, (__m512i)yes);
}
static inline vi vm_add(vm mask, vi a, vi b) {
    return (vi)_mm512_mask_add_epi32((__m512i)a, mask, (__m512i)a, (__m512i)b);
}
static inline vm vm_and(vm a, vm b) {
    return _kand_mask16(a, b);
}
static inline vm vm_without(vm a, vm b) {
    return _kandn_mask16(b, a);
}
static inline vm vm_less(vf a, vf b) {
    return _mm512_cmp_ps_mask(a, b, _CMP_LT_OQ);
}
static inline vm vm_clear(vm mask, vi v, uint32_t bits) {
    return _mm512_mask_testn_epi32_mask(mask, (__m512i)v, _mm512_set1_epi32((int32_t)bits));
}
static inline vi vm_keep(vm mask, vi v) {
    return (vi)_mm512_maskz_mov_epi32(mask, (__m512i)v);
}
static inline uint32_t vm_bits(vm mask) {
    return mask;
}
#else
typedef vi vm;
static inline vm vm_not_above(vf a, vf b) {
    return a <= b;
}
static inline vm vm_below(vm mask, vf a, vf b) {
    return mask & (a < b);
}
static inline vm vm_equal(vm mask, vi a, vi b) {
    return mask & (a == b);
}
static inline vf vf_pick(vm mask, vf yes, vf no) {
    return vf_where(mask, yes, no);
}
static inline vi vi_pick(vm mask, vi yes, vi no) {
    return (yes & mask) | (no & ~mask);
}
static inline vi vm_add(vm mask, vi a, vi b) {
    return (vi)((vu)a + (vu)(mask & b)); /* sums may wrap */
}
static inline vm vm_and(vm a, vm b) {
    return a & b;
}
static inline vm vm_without(vm a, vm b) {
    return a & ~b;
}
static inline vm vm_less(vf a, vf b) {
    return a < b;
}
static inline vm vm_clear(vm mask, vi v, uint32_t bits) {
    return mask & (((vu)v & bits) == 0);
}
static inline vi vm_keep(vm mask, vi v) {
    return mask & v;
}
static inline uint32_t vm_bits(vm mask) {
    return vi_bits(mask);
}
#endif

#endif
