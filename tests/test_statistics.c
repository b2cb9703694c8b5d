#include "statistics.h"

#include "test.h"

TEST(median_is_the_value_in_the_middle) {
    const double odd[] = {9, 1, 4};
    CHECK_NEAR(statistics_median(odd, 3), 4, 0);
    CHECK_NEAR(odd[0], 9, 0);
    const double one[] = {7};
    CHECK_NEAR(statistics_median(one, 1), 7, 0);
}

TEST(median_of_an_even_count_is_the_mean_of_the_middle_two) {
    const double even[] = {100, 3, 1, 6};
    CHECK_NEAR(statistics_median(even, 4), 4.5, 0);
}

TEST(median_takes_as_many_values_as_promised) {
    double values[STATISTICS_MAX];
    for (int i = 0; i < STATISTICS_MAX; i++)
        values[i] = STATISTICS_MAX - i;
    /* 1 .. n: the mean of n / 2 and n / 2 + 1 */
    CHECK_NEAR(statistics_median(values, STATISTICS_MAX), (STATISTICS_MAX + 1) / 2.0, 0);
}

TEST(least_is_found_wherever_it_stands) {
    const double values[] = {3, 2, 5, 1};
    CHECK_NEAR(statistics_least(values, 1), 3, 0);
    CHECK_NEAR(statistics_least(values, 3), 2, 0);
    CHECK_NEAR(statistics_least(values, 4), 1, 0);
}

/* A machine that runs at half its speed during the last two of five pairs: the first piece of work
 * takes three times as long as the second all the same. The medians apart, 6 and 1, say 6. */
TEST(pairs_cancel_what_disturbs_both) {
    const double first[] = {3, 3, 6, 6, 6}, second[] = {1, 1, 1, 2, 2};
    CHECK_NEAR(statistics_median_ratio(first, second, 5), 3, 0);
}
