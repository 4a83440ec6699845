#include "tests/end_to_end/kit/one_line.h"

#include <catch2/catch.hpp>

namespace puckloop::tests {

void check_one_line(const Ended& ended, int status, const Words& words, double within_s) {
    INFO("standard error: " << ended.err);
    CHECK(!ended.timed_out);
    CHECK(ended.seconds < within_s);
    CHECK(ended.status == status);
    CHECK(ended.error_lines() == 1);
    CHECK_THAT(ended.err, Catch::StartsWith("puckloop: "));
    for (const std::string& word : words)
        CHECK_THAT(ended.err, Catch::Contains(word));
}

}  // namespace puckloop::tests
