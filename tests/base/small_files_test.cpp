// Quantiles, and text files that are written whole.

#include "base/error.h"
#include "base/files/claimed_folder.h"
#include "base/files/new_file.h"
#include "base/files/text_file.h"
#include "base/logs/log.h"
#include "base/plain_text.h"
#include "base/quantile.h"
#include "tests/kit/scratch.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <new>
#include <sstream>
#include <stdexcept>

using namespace puckloop;
namespace fs = std::filesystem;

namespace {

std::string content(const fs::path& file) {
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    return text.str();
}

struct Folder {
    fs::path path = tests::scratch_path("puckloop-base-files");
    Folder() {
        fs::remove_all(path);
        fs::create_directories(path);
    }
    ~Folder() { fs::remove_all(path); }
};

}  // namespace

TEST_CASE("quantiles lie between the values, NaN left out") {
    CHECK(median({3, NAN, 1, 2}) == 2);
    CHECK(median({4, 1, 2, 3}) == 2.5);
    CHECK(upper_median({4, 1, 2, 3}) == 3);
    CHECK(quantile({0, 10, 20}, 0.25) == 5);
    CHECK(quantile({5, 7}, 0) == 5);
    CHECK(quantile({5, 7}, 1) == 7);
    CHECK((std::isnan(median({NAN})) && std::isnan(upper_median({}))));
}

TEST_CASE("a file or folder that cannot be made is named with the reason") {
    CHECK_THROWS_WITH(write_file("/dev/full", std::string(100000, 'x')),
                      "/dev/full: cannot be written: No space left on device");
    CHECK_THROWS_WITH(write_file("/nowhere/file", ""),
                      "/nowhere/file: cannot be written: No such file or directory");
    CHECK_THROWS_AS(make_folder("/dev/null/folder"), RunError);
}

TEST_CASE("a link in the place of a new file is not followed, a device behind one is") {
    const Folder folder;
    const fs::path victim = folder.path / "victim.txt", link = folder.path / "link.txt";
    std::ofstream(victim) << "mine";
    fs::create_symlink(victim, link);
    CHECK_THROWS_WITH(write_file(link, "ours"), Catch::Contains("is a link, which is not followed"));
    CHECK(new_file(link) == nullptr);
    CHECK(is_refused_link(link));
    CHECK(content(victim) == "mine");
    fs::create_symlink(folder.path / "nothing", folder.path / "dangling");
    CHECK_THROWS_AS(write_file(folder.path / "dangling", "ours"), RunError);
    CHECK_FALSE(fs::exists(folder.path / "nothing"));
    fs::create_symlink("/dev/null", folder.path / "null");
    CHECK_NOTHROW(write_file(folder.path / "null", "ours"));
    CHECK_THROWS_WITH(log::start("test", {log::Level::Off, link.string()}), Catch::Contains("is a link"));
    CHECK_NOTHROW(write_file(victim, "ours"));
    CHECK(content(victim) == "ours");
}

TEST_CASE("a folder without our mark keeps its files, one with it is written over, links never") {
    const Folder folder;
    std::ofstream(folder.path / "report.html") << "mine";
    CHECK_THROWS_AS(claim_folder(folder.path, ".mark", {"report.html"}), InputError);
    CHECK_THROWS_AS(claim_folder(folder.path, ".mark", {"report.html"}),
                    InputError);  // a refusal leaves none
    CHECK(content(folder.path / "report.html") == "mine");
    CHECK_NOTHROW(claim_folder(folder.path, ".mark", {"other.html"}));
    std::ofstream(folder.path / "other.html") << "ours";
    CHECK_NOTHROW(claim_folder(folder.path, ".mark", {"other.html"}));
    fs::remove(folder.path / "other.html");
    fs::create_symlink(folder.path / "report.html", folder.path / "other.html");
    CHECK_THROWS_WITH(claim_folder(folder.path, ".mark", {"other.html"}), Catch::Contains("is a link"));
    CHECK_NOTHROW(claim_folder(folder.path / "new" / "one", ".mark", {"report.html"}));
    CHECK_THROWS_AS(claim_folder("/dev/null/folder", ".mark", {}), InputError);
}

TEST_CASE("a mark makes puckloop's what it lists, and nothing else") {
    const Folder folder;
    const fs::path mark = folder.path / ".mark", report = folder.path / "report.html";
    const auto claim = [&] { claim_folder(folder.path, ".mark", {"report.html"}); };
    std::ofstream(report) << "mine";
    SECTION("one that is empty, or of other names") {
        for (const char* text : {"", "other.html\n", "report.htm\nxreport.html\n", "\n\n"}) {
            CAPTURE(text);
            std::ofstream(mark) << text;
            CHECK_THROWS_WITH(claim(), Catch::Contains("report.html: is there already") &&
                                           Catch::Contains("that does not list it"));
            CHECK(content(mark) == text);
        }
    }
    SECTION("names of earlier claims stay") {
        std::ofstream(mark) << "report.html\n./kept\n";
        claim_folder(folder.path, ".mark", {"other.html"});
        CHECK_NOTHROW(claim());
        CHECK(listed_names(content(mark)) == std::set<std::string>{"kept", "other.html", "report.html"});
    }
    SECTION("a second name of the mark's file, or of a result's") {
        const fs::path victim = folder.path / "victim.txt";
        std::ofstream(victim) << "report.html\n";
        fs::create_hard_link(victim, mark);
        CHECK_THROWS_WITH(claim(), Catch::Contains(".mark: has another name (a hard link)"));
        CHECK(content(victim) == "report.html\n");
        fs::remove(mark);
        std::ofstream(mark) << "report.html\n";
        fs::remove(report);
        fs::create_hard_link(victim, report);
        CHECK_THROWS_WITH(claim(), Catch::Contains("report.html: has another name (a hard link)"));
    }
    SECTION("what is no plain file is no mark") {
        fs::create_directories(mark);
        CHECK_THROWS_WITH(claim(), Catch::Contains(".mark: cannot be opened"));
        fs::remove(mark);
        std::ofstream(folder.path / "list") << "report.html\n";
        fs::create_symlink("list", mark);
        CHECK_THROWS_WITH(claim(), Catch::Contains(".mark: cannot be opened"));
    }
    SECTION("a folder is emptied only if it holds nothing else") {
        std::ofstream(mark) << "report.html\n./kept\n";
        CHECK(holds_only_results(folder.path, ".mark"));
        fs::create_directories(folder.path / "kept");
        CHECK(holds_only_results(folder.path, ".mark"));
        std::ofstream(folder.path / "notes.txt") << "mine";
        CHECK_FALSE(holds_only_results(folder.path, ".mark"));
    }
}

TEST_CASE("a user's text is shown on one line, without what a terminal obeys, and shortened") {
    CHECK(plain_text("plain \xc3\xa9 \xe2\x82\xac \xf0\x9f\xa4\x96", 100) ==
          "plain \xc3\xa9 \xe2\x82\xac \xf0\x9f\xa4\x96");
    CHECK(plain_text("a\x1b[31mb\nc\td\re\x7f", 100) == "a\\x1b[31mb\\nc\\td\\re\\x7f");
    CHECK(plain_text("\xc2\x9b \xe2\x80\xae \xff \xc3", 100) == "\\x9b \\u202e \\xff \\xc3");
    CHECK(plain_text("\xed\xa0\x80\xc0\xaf", 100) == "\\xed\\xa0\\x80\\xc0\\xaf");
    CHECK(plain_lines("a\nb\x07", 100) == "a\nb\\x07");
    CHECK(plain_text("a" + std::string(100'000, 'x') + "b", 100) ==
          "a" + std::string(49, 'x') + " ... (99,902 bytes left out) ... " + std::string(49, 'x') + "b");
    const InputError error("f\x1b", "line\n1", "bad '" + std::string(1'000'000, '\x1b') + "'", "good");
    const std::string what = error.what();
    CHECK(what.size() < 20'000);
    CHECK(what.find_first_of("\x1b\n") == std::string::npos);
    CHECK(what.ends_with("' (expected good)"));
    CHECK(error.file() == "f\x1b");
}

TEST_CASE("reasons have no library's words") {
    CHECK(reason_of(std::bad_alloc()) == "not enough memory");
    CHECK(reason_of(std::length_error("vector::_M_default_append")).find("_M_") == std::string::npos);
    CHECK(reason_of(RunError("the disk is full")) == "the disk is full");
}
