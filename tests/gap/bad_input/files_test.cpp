// Files as editors, spreadsheets and broken disks leave them.

#include "gap/reading/read_experiment.h"
#include "tests/gap/bad_input/made_experiment.h"

#include <catch2/catch.hpp>

#include <sys/stat.h>

using namespace puckloop::gap;
using namespace puckloop::gap::tests;
using Catch::Matchers::Contains;

namespace {

constexpr const char* kToml = "kind = \"ground\"\n[[run]]\nfile = \"a.csv\"\n";

std::string table() {
    std::string text = "t_s,sensor,grey,reading\n";
    for (int i = 0; i < 60; ++i)
        text += fmt::format("{:.1f},{},{:.2f},{}\n", i * 0.1, i % 3, i % 5 / 4.0,
                            331 + 155 * (i % 5) + i * 37 % 11);
    return text;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
        text.replace(at, from.size(), to);
    return text;
}

std::string of_csv(const std::string& csv, std::string* cautions = nullptr) {
    const Folder folder;
    write_file(folder.path() / "experiment.toml", kToml);
    write_file(folder.path() / "a.csv", csv);
    return refusal(folder.path(), cautions);
}

std::string of_toml(const std::string& toml) {
    const Folder folder;
    write_file(folder.path() / "experiment.toml", toml);
    write_file(folder.path() / "a.csv", table());
    return refusal(folder.path());
}

}  // namespace

TEST_CASE("line ends, separators, byte order marks and comments of all sorts are read") {
    CHECK(of_csv(table()) == "");
    CHECK(of_csv(replaced(table(), "\n", "\r\n")) == "");
    CHECK(of_csv("\xEF\xBB\xBF" + table()) == "");
    CHECK(of_csv(replaced(table(), ",", ";")) == "");
    CHECK(of_csv(replaced(table(), ",", "\t")) == "");
    CHECK(of_csv("# by hand\n\n" + table() + "\n\n") == "");
    std::string cautions;
    const std::string latin =
        replaced(replaced(table(), "reading\n", "reading,temp\xE9rature\n"), "\n", ",20\n");
    CHECK(of_csv(latin.substr(0, latin.find(",20\n")) + latin.substr(latin.find(",20\n") + 3), &cautions) ==
          "");
    CHECK_THAT(cautions, Contains("temp?rature"));
    CHECK(of_csv(replaced(table(), "sensor", "Sensor"), &cautions) == "");
    CHECK_THAT(cautions, Contains("column \"Sensor\" is not used; did you mean \"sensor\"?"));
}

TEST_CASE("files that cannot be used are refused with a line") {
    CHECK_THAT(of_csv(""), Contains("empty"));
    CHECK_THAT(of_csv("t_s,sensor,grey,reading\n"), Contains("no rows"));
    CHECK_THAT(of_csv(table() + "6.0,1,0.5\n"), Contains("row 61") && Contains("3 cells"));
    CHECK_THAT(of_csv(table() + "6.0,1,0.5,300,7\n"), Contains("row 61") && Contains("5 cells"));
    CHECK_THAT(of_csv(replaced(table(), "sensor", "reading")), Contains("twice"));
    CHECK_THAT(of_csv(table().substr(table().find('\n') + 1)), Contains("header"));
    CHECK_THAT(of_csv(replaced(table(), "0.25,", "0,25,")),
               Contains("row 2") && Contains("5 cells") && Contains("semicolons"));
    CHECK_THAT(of_csv(replaced(table(), "\n", "\r")), Contains("carriage returns"));
    CHECK_THAT(of_csv(replaced(table(), ",", " ")), Contains("header: has only blanks between names"));
    CHECK_THAT(of_csv("\xFF\xFE" + table()), Contains("UTF-16"));
    CHECK_THAT(of_csv(replaced(table(), "reading", "Reading")), Contains("\"Reading\"?"));
    CHECK_THAT(of_csv(table() + "6.0,1,0.5,n/a\n"), Contains("row 61") && Contains("n/a"));
    CHECK_THAT(of_csv(std::string("\0\1\2\n\3", 5)), Contains("a.csv: header: is binary, not text"));
    CHECK_THAT(of_csv(table() + std::string("\0\1,2,3,4\n", 9)), Contains("row 61: is binary"));
    CHECK_THAT(of_csv("PK\x03\x04" + table()), Contains("a spreadsheet") && Contains("saved as CSV"));
    const Folder folder;
    CHECK_THAT(refusal(folder.path() / "none"), Contains("none: is not there"));
    write_file(folder.path() / "experiment.toml", kToml);
    CHECK_THAT(refusal(folder.path()), Contains("a.csv: is not there"));
    std::filesystem::create_directory(folder.path() / "a.csv");
    CHECK_THAT(refusal(folder.path()), Contains("a.csv: is a folder, not a file"));
    CHECK_THAT(refusal(folder.path() / "experiment.toml"), Contains("not a folder"));
}

TEST_CASE("lines that are quoted as a whole are refused once") {
    CHECK_THAT(of_csv("\"grey,reading\"\n\"0.1,300\"\n\"0.2,400\"\n"),
               Contains("header") && Contains("one quoted cell with separators in it"));
}

TEST_CASE("all headers with other capitals are named at once") {
    const std::string line =
        of_csv(replaced(replaced(replaced(table(), "t_s", "T_s"), "grey", "Grey"), "reading", "READING"));
    CHECK_THAT(
        line,
        Contains(
            "has no column \"reading\" (reflected counts; did you mean \"READING\"?), none \"grey\" (") &&
            Contains("did you mean \"Grey\"?") && Contains("t_s for \"T_s\""));
    CHECK_THAT(of_csv(replaced(table(), "grey", "Grey")),
               Contains("no column \"grey\"") && !Contains("none"));
}

TEST_CASE("an experiment.toml that is none gives one line with what to do") {
    const Folder folder;
    const auto file = folder.path() / "experiment.toml";
    const auto one_line = [&](const char* problem) {
        CHECK_THAT(refusal(folder.path()),
                   Contains(std::string("experiment.toml: ") + problem) && Contains("gap new KIND DIR"));
    };
    one_line("is not there");
    write_file(file, std::string("\x7F"
                                 "ELF\2\1\1\0\0",
                                 9) +
                         kToml);
    one_line("is binary, not text");
    std::filesystem::remove(file);
    std::filesystem::create_directory(file);
    one_line("is a folder, not a file");
}

TEST_CASE("decimal commas between semicolons or tabs are read, where all numbers have them") {
    const Folder points, commas;
    std::string cautions;
    const std::string german = replaced(replaced(table(), ",", ";"), ".", ",");
    for (const char* separator : {";", "\t"}) {
        for (const auto* folder : {&points, &commas})
            write_file(folder->path() / "experiment.toml", kToml);
        write_file(points.path() / "a.csv", table());
        write_file(commas.path() / "a.csv", replaced(german, ";", separator));
        CHECK(read_experiment(commas.path()).runs.front().columns ==
              read_experiment(points.path()).runs.front().columns);
        CHECK(refusal(commas.path(), &cautions) == "");
        CHECK_THAT(cautions, Contains("0,5 is 0.5") && Contains("1 of 1 files"));
    }
    CHECK_THAT(of_csv(german + "6.0;1;0,5;300\n"),
               Contains("row 61") && Contains("column \"t_s\"") && Contains("one decimal point throughout"));
    CHECK_THAT(of_csv(german + "6,0;1;0,5;1.300,0\n"), Contains("row 61") && Contains("thousands"));
}

TEST_CASE("decimal commas in quotes between commas are read, thousands are refused") {
    const auto quoted = [](const char* grey, const char* reading) {
        std::string text = "\"t_s\",\"sensor\",\"grey\",\"reading\"\n";
        for (int i = 0; i < 60; ++i)
            text += fmt::format("{},\"{}\",{},{}\n", i, i % 3, replaced(grey, "#", std::to_string(i % 5)),
                                replaced(replaced(reading, "#", std::to_string(i % 5)), "@",
                                         std::to_string(i * 37 % 11 + 100)));
        return text;
    };
    std::string cautions;
    CHECK(of_csv(quoted("\"0,#5\"", "#@"), &cautions) == "");
    CHECK_THAT(cautions, Contains("0,5 is 0.5") && Contains("1 of 1 files"));
    const Folder folder;
    write_file(folder.path() / "experiment.toml", kToml);
    write_file(folder.path() / "a.csv", quoted("\"0,#5\"", "#@"));
    CHECK(read_experiment(folder.path()).runs.front().column("grey")[3] == 0.35);
    // Whole numbers beside "1,104" show nothing of which it is.
    CHECK_THAT(of_csv(quoted("0", "\"1,@\"")), Contains("column \"reading\"") && Contains("1200 or 1.2"));
    // Nor do decimal commas of another column.
    CHECK_THAT(of_csv(quoted("\"0,#5\"", "\"2,@\"")),
               Contains("column \"reading\"") && Contains("1200 or 1.2"));
    // A point elsewhere, or a second comma, shows that commas part thousands.
    CHECK_THAT(of_csv(quoted("0.#", "\"1,@\"")), Contains("\"reading\"") && Contains("between thousands"));
    CHECK_THAT(of_csv(quoted("0", "\"1,#00,@\"")), Contains("between thousands"));
    CHECK_THAT(of_csv(table() + "6.0,1,\"0.5,300\n"),
               Contains("row 61") && Contains("a quote that its line does not close"));
}

TEST_CASE("commas that may part thousands are read as decimal commas, with a caution") {
    // Three digits behind every comma, none of four without it: "331" is then 331 counts, "1,106" 1.106.
    const auto readings = [](const char* (*cell)(int)) {
        std::string text = "t_s;sensor;grey;reading\n", cautions;
        for (int i = 0; i < 60; ++i)
            text += fmt::format("{};{};{};{}\n", i, i % 3, (i + 1) % 2, cell(i));
        of_csv(text, &cautions);
        return cautions;
    };
    const auto caution = [](const std::string& cautions) {
        return cautions.find(
                   "\"reading\" has three digits behind every comma in 1 of 1 files: read as decimals "
                   "(1,200 is 1.2), not as thousands") != std::string::npos;
    };
    CHECK(caution(readings([](int i) { return i % 2 == 0 ? "331" : "1,106"; })));
    CHECK(caution(readings([](int i) { return i % 2 == 0 ? "+12,331" : "-1,106"; })));
    CHECK_FALSE(caution(readings([](int i) { return i % 2 == 0 ? "1331" : "1,106"; })));
    CHECK_FALSE(caution(readings([](int i) { return i % 2 == 0 ? "0,331" : "1,106"; })));
    CHECK_FALSE(caution(readings([](int i) { return i % 2 == 0 ? "1,33" : "1,106"; })));
    CHECK_FALSE(caution(readings([](int i) { return i % 2 == 0 ? "331" : "106"; })));
}

TEST_CASE("pipes and devices, which may never end, are not waited for") {
    const Folder folder;
    write_file(folder.path() / "experiment.toml", "kind = \"ground\"\n[[run]]\nfile = \"/dev/zero\"\n");
    CHECK_THAT(refusal(folder.path()), Contains("/dev/zero: is a pipe or device"));
    write_file(folder.path() / "experiment.toml", kToml);
    REQUIRE(::mkfifo((folder.path() / "a.csv").c_str(), 0600) == 0);
    CHECK_THAT(refusal(folder.path()), Contains("a.csv: is a pipe or device, which may never end"));
    std::filesystem::remove(folder.path() / "experiment.toml");
    REQUIRE(::mkfifo((folder.path() / "experiment.toml").c_str(), 0600) == 0);
    CHECK_THAT(refusal(folder.path()), Contains("experiment.toml: is a pipe"));
    const auto loop = folder.path() / "loop";
    std::filesystem::create_symlink("loop", loop);
    CHECK_THAT(refusal(loop), Contains("not a folder"));
}

TEST_CASE("descriptions that cannot be used are refused with a line") {
    const std::string run = "[[run]]\nfile = \"a.csv\"\n";
    CHECK(of_toml(kToml) == "");
    CHECK(of_toml(replaced(kToml, "\n", "\r\n")) == "");
    CHECK_THAT(of_toml(""), Contains("kind"));
    CHECK_THAT(of_toml("kind = \"grond\"\n" + run), Contains("ground"));
    CHECK_THAT(of_toml("kind = 3\n" + run), Contains("not a text"));
    CHECK_THAT(of_toml("kind = \"ground\"\n"), Contains("no run"));
    CHECK_THAT(of_toml("kind = \"ground\n" + run), Contains("line 1"));
    CHECK_THAT(of_toml("kind = \"ground\"\nkind = \"motion\"\n" + run), Contains("line 2"));
    CHECK_THAT(of_toml("kind = \"ground\"\ntitel = \"x\"\n" + run), Contains("title"));
    CHECK_THAT(of_toml("kind = \"ground\"\ntitle = \"caf\xE9\"\n" + run), Contains("line 2"));
    CHECK_THAT(of_toml("kind = \"ground\"\n[columns]\nt_s = \"kg\"\n" + run),
               Contains("\"kg\" (expected s, ms, us, ns, min, h)"));
    CHECK_THAT(of_toml("kind = ground\n" + run), Contains("line 1") && Contains("texts in quotes"));
    CHECK_THAT(of_toml("kind = \"ground\"\n" + run + "sesion = \"x\"\n"), Contains("perhaps 'session'"));
    CHECK_THAT(of_toml("kind = \"ground\"\n" + run + run), Contains("a.csv is named by two runs"));
    CHECK_THAT(of_toml("kind = \"ground\"\n" + run + "[[run]]\nfile = \"./a.csv\"\n"),
               Contains("a.csv, also written ./a.csv, is named by two runs (expected each file once)"));
    CHECK_THAT(
        of_toml("kind = \"ground\"\n[[run]]\nfile = \"\"\n"),
        Contains("line 3: run 1: file names nothing (expected a CSV file of the experiment's folder)"));
    CHECK_THAT(of_toml("kind = \"ground\"\n[columns]\ngrey = 3\n" + run),
               Contains("line 3: column grey is neither unit nor table") && Contains("{ from ="));
    CHECK_THAT(of_toml("kind = \"ground\"\n[instrument]\nreading = 3\n" + run),
               Contains("line 3: instrument reading is not a table (expected { floor = 0,"));
    for (const char* key : {"session", "unit"})
        CHECK_THAT(
            of_toml("kind = \"ground\"\n" + run + key + " = [1]\n"),
            Contains(std::string("line 4: ") + key + " is not a number (expected a number, or a name"));
    for (const std::string twice :
         {"[columns]\n[columns]\n", "nominal = 3\n[nominal]\n", "[run]\nname = \"a\"\n"})
        CHECK_THAT(of_toml("kind = \"ground\"\n" + twice + run),
                   Contains("each key and each table once") && !Contains("insert_value"));
    CHECK_THAT(of_toml("kind = \"ground\"\n[columns]\ngray = \"1\"\n" + run), Contains("grey"));
    CHECK_THAT(of_toml("kind = \"ground\"\n[columns]\ngrey = { from = \"shade\" }\n" + run),
               Contains("shade"));
    // Of optional columns, too: the analysis would go on without them, or with one column as two.
    CHECK_THAT(
        of_toml("kind = \"ground\"\n[columns]\npitch_rad = { from = \"pitch\", unit = \"deg\" }\n" + run),
        Contains("line 3") && Contains("\"pitch\", which no file has"));
    CHECK_THAT(of_toml("kind = \"ground\"\n[columns]\nacceleration = { from = \"grey\" }\n" + run),
               Contains("both the column \"grey\""));
    CHECK_THAT(of_toml("kind = \"ground\"\n[nominal]\n\"ground.white\" = nan\n" + run), Contains("finite"));
    CHECK_THAT(of_toml(run + "kind = \"ground\"\n"), Contains("kind"));
    const int deep = 20000;
    CHECK_THAT(
        of_toml("kind = \"ground\"\nx = " + std::string(deep, '[') + std::string(deep, ']') + "\n" + run),
        Contains("line 2") && Contains("deep"));
}
