// Words that docs/glossary.md has replaced stay out: names in code, messages, docs.

#include "tests/names/source_files.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

using namespace puckloop::names;

namespace {

/// Names that code had and that field terms have replaced.
constexpr std::array kOldNames{"loop_walk",       "skip_loops",     "steady_leap",     "service_shortcut",
                               "land_after",      "keep_house",     "wishes_",         "stopper_",
                               "sort_channels",   "told_wall_",     "told_time_",      "hurried",
                               "Chats",           "chats_",         "said_before",     "judge_punctuality",
                               "dazzle_",         "heeded",         "look_at_heeded",  "heeds_clock_pin",
                               "lend_pins",       "ruled_by_lower", "pay_cycle",       "anew_",
                               "FollowedRoutine", "Leapt",          "note_leap",       "IrFate",
                               "BurstFate",       "IrHarm",         "set_harm",        "Complaints",
                               "first_complaint", "LinuxLateness",  "read_lateness",   "passed_over",
                               "RunDiary",        "run_diary",      "hand_out_faults", "Foresight",
                               "TakenBack",       "Meddler",        "meddled",         "kHopeless",
                               "kGlimpse",        "kSeedDelivered", "ir_fate",         "ir_harm"};

/// Words and phrases that no page, no message and no comment has.
constexpr std::array kOldWords{"told",
                               "reckon",
                               "reckoned",
                               "mend",
                               "mended",
                               "so-manieth",
                               "hurried",
                               "heeded",
                               "words of light",
                               "a process a node",
                               "a line an event",
                               "a file each",
                               "one file a chapter"};

/// And what messages said.
constexpr std::array kOldMessages{"cannot suffer", "seed simulator", "place to listen", "lies on the bench"};

/// The same for comments, where these are out as well.
constexpr std::array kOldInComments{"tells", "reckoning", "leapt", "passed over", "lateness"};

bool part_of_name(char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
}

/// Whether `text` has `word` and neither neighbour makes it part of another one.
bool has_word(std::string_view text, std::string_view word) {
    for (std::size_t at = text.find(word); at != std::string_view::npos; at = text.find(word, at + 1)) {
        const std::size_t end = at + word.size();
        if ((at == 0 || !part_of_name(text[at - 1])) && (end == text.size() || !part_of_name(text[end])))
            return true;
    }
    return false;
}

bool is_code(const SourceFile& file) {
    return file.ends_with(".h") || file.ends_with(".cpp") || file.ends_with(".c");
}

/// Files that may have the words, each with its reason.
bool allowed(const SourceFile& file) {
    return file.in("firmware")                 // sources are held to their images by hash
           || file.in("tests/names")           // the lists above
           || file.path == "docs/glossary.md"  // what replaced what
           || file.path == "CHANGELOG.md"      // names what was renamed
           // The analysis gets its names with its redesign.
           || file.in("gap") || file.in("selftest") || file.in("tests/gap") || file.in("tools/gap") ||
           file.path.starts_with("docs/gap");
}

}  // namespace

TEST_CASE("no name is one that a term of the field has replaced") {
    int files = 0;
    for (const SourceFile& file : source_files()) {
        if (allowed(file)) continue;
        ++files;
        for (std::size_t n = 0; n < file.lines.size(); ++n)
            for (const std::string_view name : kOldNames)
                if (has_word(file.lines[n], name))
                    FAIL_CHECK(file.path << ":" << n + 1 << ": '" << name << "', see docs/glossary.md");
    }
    CHECK(files > 1000);
}

TEST_CASE("no message and no page has a word that the glossary has replaced") {
    int messages = 0, pages = 0;
    for (const SourceFile& file : source_files()) {
        if (allowed(file)) continue;
        const bool page = file.ends_with(".md");
        // Names of test cases and what test programs print reach no user.
        if (!page && (!is_code(file) || file.in("tests"))) continue;
        pages += page ? 1 : 0;
        for (std::size_t n = 0; n < file.lines.size(); ++n) {
            const std::vector<std::string> texts =
                page ? std::vector<std::string>{file.lines[n]} : literals(file.lines[n]);
            messages += page ? 0 : static_cast<int>(texts.size());
            for (const std::string& text : texts) {
                const auto refuse = [&](std::string_view word) {
                    if (has_word(text, word))
                        FAIL_CHECK(file.path << ":" << n + 1 << ": '" << word << "', see docs/glossary.md");
                };
                std::ranges::for_each(kOldWords, refuse);
                std::ranges::for_each(kOldMessages, refuse);
            }
        }
    }
    CHECK(messages > 5000);
    CHECK(pages > 40);
}

TEST_CASE("no comment has a word that the glossary has replaced") {
    int comments = 0;
    for (const SourceFile& file : source_files()) {
        // What tests say of their cases reads as sentences of their own.
        if (allowed(file) || file.in("tests") || !is_code(file)) continue;
        for (std::size_t n = 0; n < file.lines.size(); ++n) {
            const std::string text = comment(file.lines[n]);
            comments += text.empty() ? 0 : 1;
            const auto refuse = [&](std::string_view word) {
                if (has_word(text, word))
                    FAIL_CHECK(file.path << ":" << n + 1 << ": '" << word << "', see docs/glossary.md");
            };
            std::ranges::for_each(kOldWords, refuse);
            std::ranges::for_each(kOldInComments, refuse);
        }
    }
    CHECK(comments > 5000);
}

TEST_CASE("words are found as a whole, in literals and not in comments") {
    CHECK(has_word("a told b", "told"));
    CHECK_FALSE(has_word("untold", "told"));
    CHECK_FALSE(has_word("told_", "told"));
    CHECK(literals(R"(    fail("one \"two\"", 'x', "three");  // "four")") ==
          std::vector<std::string>{R"(one "two")", "three"});
    CHECK(comment(R"(    fail("// no");  // yes)") == " yes");
    CHECK(comment(R"(f("a \" // b"))").empty());
    CHECK(literals(R"(// "told")").empty());
    CHECK(literals(R"(#include "told.h")").empty());
}
