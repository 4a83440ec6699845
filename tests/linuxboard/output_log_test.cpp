// A program's log is bounded, on disk while it runs as well as at its end.

#include "linuxboard/shim/node/output_log.h"
#include "tests/kit/scratch.h"

#include <catch2/catch.hpp>

#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <iterator>

using puckloop::linuxboard::OutputLog;

namespace {

constexpr off_t kBlock = 512;  // of st_blocks
constexpr off_t kPiece = 1 << 20;

void print(const OutputLog& log, const std::string& text, off_t bytes) {
    for (off_t written = 0; written < bytes; written += static_cast<off_t>(text.size()))
        REQUIRE(write(log.descriptor(), text.data(), text.size()) == static_cast<ssize_t>(text.size()));
}

std::string behind(const std::filesystem::path& file, off_t from) {
    std::ifstream log(file, std::ios::binary);
    log.seekg(from);
    return {std::istreambuf_iterator<char>(log), std::istreambuf_iterator<char>()};
}

}  // namespace

TEST_CASE("output beyond the bound takes no disk, and the log's last line counts it") {
    const std::filesystem::path file = puckloop::tests::scratch_path("output.log");
    struct stat status {};
    {
        OutputLog log(file);
        const std::string lines = std::string(kPiece - 1, 'x') + '\n';
        print(log, lines, OutputLog::kMost);
        for (int more = 0; more < 40; ++more) {
            print(log, lines, kPiece);
            log.release();
        }
        REQUIRE(stat(file.c_str(), &status) == 0);
        CHECK(status.st_size == OutputLog::kMost + 40 * kPiece);
        CHECK(status.st_blocks * kBlock <= OutputLog::kMost + 3 * kPiece);
        CHECK(behind(file, status.st_size - 100) == std::string(99, 'x') + '\n');  // the last lines are there
    }
    CHECK(behind(file, OutputLog::kMost - 2) ==
          "x\npuckloop: the other 41943040 bytes of the output are left out\n");
}

TEST_CASE("output within the bound is kept as it is") {
    const std::filesystem::path file = puckloop::tests::scratch_path("output.log");
    {
        OutputLog log(file);
        print(log, std::string(kPiece, 'x'), OutputLog::kMost);
        log.release();
    }
    CHECK(std::filesystem::file_size(file) == static_cast<std::uintmax_t>(OutputLog::kMost));
    { const OutputLog anew(file); }
    CHECK(std::filesystem::file_size(file) == 0);
}
