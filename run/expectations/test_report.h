#pragma once
// A run as a test suite, for CI: the run itself is its first case, each [[expect]] table another.

#include "cosim/conductor.h"
#include "run/description/run_setup.h"
#include "run/report/expectation_result.h"

#include <filesystem>
#include <string>
#include <vector>

namespace puckloop::tools {

struct TestSuite {
    std::string name;      ///< of the scenario
    std::string trouble;   ///< why the run failed apart from what was expected of it; empty: it did not
    std::string scenario;  ///< its file
    std::string out;       ///< its results
    double wall_s = 0.0;
    std::vector<ExpectationResult> results;
};

/// JUnit's XML, as Jenkins, GitLab and GitHub's actions read it; TAP, version 13.
std::string junit_text(const TestSuite& suite);
std::string tap_text(const TestSuite& suite);

/// Both, where the user asked for them. A file that cannot be written makes the run fail.
void write_test_reports(const std::filesystem::path& junit, const std::filesystem::path& tap,
                        const TestSuite& suite, cosim::Outcome& outcome);

}  // namespace puckloop::tools
