/* Building the hierarchy: top down, where the surface area heuristic (MacDonald and Booth 1990),
 * estimated in bins (Wald 2007), says that rays cost least.
 *
 * A subtree over n triangles has at most n - 1 nodes. It gets the place of n - 1 nodes, so that
 * subtrees can be built in any order and on any thread and still come out the same. */
#include "../strict.h"

#include "bvh.h"

#include <float.h>
#include <math.h>

enum {
    BINS = 16,
    LEAF_MAX = 4,
    PARALLEL_DEPTH = 6,  /* subtrees below it are tasks */
    HEURISTIC_DEPTH = 40 /* below it triangles are halved: 30 levels more at most */
};

/* A triangle while its place is sought. */
typedef struct primitive {
    float box[2][3];
    uint32_t triangle;
} primitive;

typedef struct bounds {
    float box[2][3];
} bounds;

/* A subtree to be built: primitives begin .. end - 1, nodes from first_node on. */
typedef struct subtree {
    shb_bvh_child *child; /* where it hangs */
    uint32_t begin, end, first_node, depth;
} subtree;

typedef struct builder {
    primitive *primitives;
    shb_bvh_node *nodes;
    subtree tasks[1 << PARALLEL_DEPTH];
    size_t task_count;
    const shb_triangle *source;
    shb_bvh *bvh;
} builder;

/* Where to cut: primitives whose bin along the axis is below it go left. */
typedef struct cut {
    int axis; /* -1: none found */
    int bin;
    float start, scale;
    double cost;
} cut;

static float round_down(double x) {
    if (x > (double)FLT_MAX)
        return FLT_MAX;
    if (x < -(double)FLT_MAX)
        return -INFINITY;
    const float rounded = (float)x;
    return (double)rounded > x ? nextafterf(rounded, -INFINITY) : rounded;
}

static float round_up(double x) {
    return -round_down(-x);
}

static bounds empty_bounds(void) {
    return (bounds){{{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}}};
}

static void grow(bounds *b, const float lo[3], const float hi[3]) {
    for (int i = 0; i < 3; i++) {
        b->box[0][i] = lo[i] < b->box[0][i] ? lo[i] : b->box[0][i];
        b->box[1][i] = hi[i] > b->box[1][i] ? hi[i] : b->box[1][i];
    }
}

static primitive make_primitive(const shb_triangle *triangle, uint32_t number) {
    bounds b = empty_bounds();
    for (int k = 0; k < 3; k++) {
        float lo[3], hi[3];
        for (int i = 0; i < 3; i++) {
            lo[i] = round_down(triangle->corners[k][i]);
            hi[i] = round_up(triangle->corners[k][i]);
        }
        grow(&b, lo, hi);
    }
    primitive result = {.triangle = number};
    for (int i = 0; i < 3; i++) {
        result.box[0][i] = b.box[0][i];
        result.box[1][i] = b.box[1][i];
    }
    return result;
}

/* The middle of a primitive's box along an axis, kept finite. */
static float middle(const primitive *p, int axis) {
    const float limit = FLT_MAX / 4;
    const float m = 0.5f * p->box[0][axis] + 0.5f * p->box[1][axis];
    return m < limit ? (m > -limit ? m : -limit) : limit;
}

static double half_area(const bounds *b) {
    const double x = (double)b->box[1][0] - (double)b->box[0][0];
    const double y = (double)b->box[1][1] - (double)b->box[0][1];
    const double z = (double)b->box[1][2] - (double)b->box[0][2];
    return x * y + y * z + z * x;
}

static int bin_of(const cut *c, const primitive *p) {
    const float bin = (middle(p, c->axis) - c->start) * c->scale;
    return bin < BINS - 1 ? (int)bin : BINS - 1;
}

/* Tries every boundary between the bins of one axis, whose first and last are never empty. */
static void improve_cut(const primitive *primitives, uint32_t count, cut candidate, cut *best) {
    bounds bins[BINS];
    uint32_t counts[BINS] = {0};
    for (int k = 0; k < BINS; k++)
        bins[k] = empty_bounds();
    for (uint32_t i = 0; i < count; i++) {
        const int k = bin_of(&candidate, &primitives[i]);
        counts[k]++;
        grow(&bins[k], primitives[i].box[0], primitives[i].box[1]);
    }
    double right_cost[BINS];
    bounds right = empty_bounds();
    uint32_t right_count = 0;
    for (int k = BINS - 1; k > 0; k--) {
        grow(&right, bins[k].box[0], bins[k].box[1]);
        right_count += counts[k];
        right_cost[k] = half_area(&right) * right_count;
    }
    bounds left = empty_bounds();
    uint32_t left_count = 0;
    for (int k = 1; k < BINS; k++) {
        grow(&left, bins[k - 1].box[0], bins[k - 1].box[1]);
        left_count += counts[k - 1];
        candidate.cost = half_area(&left) * left_count + right_cost[k];
        candidate.bin = k;
        if (candidate.cost < best->cost)
            *best = candidate;
    }
}

/* The cheapest cut of all axes. */
static cut find_cut(const primitive *primitives, uint32_t count) {
    bounds middles = empty_bounds();
    for (uint32_t i = 0; i < count; i++) {
        const float m[3] = {middle(&primitives[i], 0), middle(&primitives[i], 1),
                            middle(&primitives[i], 2)};
        grow(&middles, m, m);
    }
    cut best = {.axis = -1, .cost = HUGE_VAL};
    for (int axis = 0; axis < 3; axis++) {
        const float start = middles.box[0][axis], width = middles.box[1][axis] - start;
        const float scale = BINS / width;
        if (width > 0 && scale < FLT_MAX)
            improve_cut(primitives, count, (cut){.axis = axis, .start = start, .scale = scale},
                        &best);
    }
    return best;
}

/* Moves the primitives left of the cut to the front; returns how many there are. */
static uint32_t partition(primitive *primitives, uint32_t count, const cut *c) {
    uint32_t left = 0, right = count;
    while (left < right) {
        if (bin_of(c, &primitives[left]) < c->bin) {
            left++;
            continue;
        }
        right--;
        const primitive moved = primitives[left];
        primitives[left] = primitives[right];
        primitives[right] = moved;
    }
    return left;
}

/* Sets the box, and decides where to cut: 0 makes a leaf. */
static uint32_t divide(const builder *b, const subtree *tree) {
    primitive *primitives = b->primitives + tree->begin;
    const uint32_t count = tree->end - tree->begin;
    bounds all = empty_bounds();
    for (uint32_t i = 0; i < count; i++)
        grow(&all, primitives[i].box[0], primitives[i].box[1]);
    for (int i = 0; i < 3; i++) {
        tree->child->box[0][i] = all.box[0][i];
        tree->child->box[1][i] = all.box[1][i];
    }
    if (count == 1)
        return 0;
    cut best = {.axis = -1, .cost = HUGE_VAL};
    if (tree->depth < HEURISTIC_DEPTH)
        best = find_cut(primitives, count);
    /* visiting a node costs about as much as one triangle */
    const double area = half_area(&all);
    if (count <= LEAF_MAX && !(best.cost + area < area * count))
        return 0;
    return best.axis < 0 ? count / 2 : partition(primitives, count, &best);
}

static void build(builder *b, const subtree *tree, bool collects_tasks) {
    if (collects_tasks && tree->depth == PARALLEL_DEPTH) {
        b->tasks[b->task_count++] = *tree;
        return;
    }
    const uint32_t left = divide(b, tree);
    shb_bvh_child *child = tree->child;
    child->first = left ? tree->first_node : tree->begin;
    child->count = left ? 0 : tree->end - tree->begin;
    if (!left)
        return;
    shb_bvh_node *node = &b->nodes[tree->first_node];
    const uint32_t middle_primitive = tree->begin + left, depth = tree->depth + 1;
    const subtree halves[2] = {
        {&node->children[0], tree->begin, middle_primitive, tree->first_node + 1, depth},
        {&node->children[1], middle_primitive, tree->end, tree->first_node + left, depth},
    };
    build(b, &halves[0], collects_tasks);
    build(b, &halves[1], collects_tasks);
}

static void build_task(void *arg, size_t index) {
    builder *b = arg;
    build(b, &b->tasks[index], false);
}

/* Triangles go through the parallel loops in blocks of this many. */
enum { BLOCK = 4096 };

static uint32_t block_end(size_t index, uint32_t count) {
    const size_t end = (index + 1) * BLOCK;
    return end < count ? (uint32_t)end : count;
}

static size_t block_count(uint32_t count) {
    return ((size_t)count + BLOCK - 1) / BLOCK;
}

static void make_primitives(void *arg, size_t index) {
    builder *b = arg;
    for (uint32_t i = (uint32_t)(index * BLOCK); i < block_end(index, b->bvh->count); i++)
        b->primitives[i] = make_primitive(&b->source[i], i);
}

static void gather_triangles(void *arg, size_t index) {
    builder *b = arg;
    for (uint32_t i = (uint32_t)(index * BLOCK); i < block_end(index, b->bvh->count); i++) {
        b->bvh->triangles[i] = b->source[b->primitives[i].triangle];
        b->bvh->slots[b->bvh->triangles[i].id] = i;
    }
}

static void run_build(const shb_context *context, builder *b) {
    shb_bvh *bvh = b->bvh;
    for (uint32_t id = 0; id < bvh->id_count; id++)
        bvh->slots[id] = SHB_ID_NONE;
    if (bvh->count == 0)
        return;
    shb_parallel_for(context, make_primitives, b, block_count(bvh->count));
    const subtree whole = {&bvh->root, 0, bvh->count, 0, 0};
    build(b, &whole, true);
    shb_parallel_for(context, build_task, b, b->task_count);
    shb_parallel_for(context, gather_triangles, b, block_count(bvh->count));
}

bool shb_bvh_build(const shb_context *context, const shb_triangle *triangles, uint32_t count,
                   uint32_t id_count, shb_bvh *bvh) {
    shb_bvh built = {.count = count, .id_count = id_count};
    built.nodes = shb_alloc(context, count, sizeof *built.nodes);
    built.triangles = shb_alloc(context, count, sizeof *built.triangles);
    built.slots = shb_alloc(context, id_count, sizeof *built.slots);
    builder *b = shb_alloc(context, 1, sizeof *b);
    primitive *primitives = shb_alloc(context, count, sizeof *primitives);
    const bool complete = built.nodes && built.triangles && built.slots && b && primitives;
    if (complete) {
        *b = (builder){.primitives = primitives, .nodes = built.nodes};
        b->source = triangles;
        b->bvh = bvh;
        *bvh = built;
        run_build(context, b);
    } else {
        shb_bvh_free(context, &built);
    }
    shb_free(context, primitives);
    shb_free(context, b);
    return complete;
}

void shb_bvh_free(const shb_context *context, shb_bvh *bvh) {
    shb_free(context, bvh->nodes);
    shb_free(context, bvh->triangles);
    shb_free(context, bvh->slots);
}

const shb_triangle *shb_bvh_find(const shb_bvh *bvh, uint32_t id) {
    if (id >= bvh->id_count || bvh->slots[id] == SHB_ID_NONE)
        return NULL;
    return &bvh->triangles[bvh->slots[id]];
}
