// puckloop asm and puckloop disasm from the outside.
#include "tests/tools/shell.h"

#include <catch2/catch.hpp>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

using puckloop::tests::Ran;
using puckloop::tests::run_puckloop;

namespace {

namespace fs = std::filesystem;

class Folder {
  public:
    Folder() {
        fs::remove_all(path_);
        fs::create_directories(path_);
    }
    ~Folder() { fs::remove_all(path_); }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    std::string file(const std::string& name, const std::string& content = "") const {
        if (!content.empty()) std::ofstream(path_ / name) << content;
        return (path_ / name).string();
    }

  private:
    fs::path path_ = fs::temp_directory_path() / ("puckloop_asm_commands." + std::to_string(::getpid()));
};

std::string content_of(const std::string& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

const std::string kSource =
    "        goto      start\n        .org      0x100\n"
    "start:  mov       #0x1234, w0\n        mov       PORTA, w1\nloop:   bra       loop\n"
    "        .org      0xf80000\n        .pword    0xc706\n";

}  // namespace

TEST_CASE("asm, disasm and asm again give the same program") {
    const Folder folder;
    const std::string source = folder.file("a.s", kSource);
    const std::string first = folder.file("first.hex");
    const Ran assembled = run_puckloop("asm " + source + " -o " + first);
    CHECK(assembled.output == "");
    CHECK(assembled.status == 0);
    const std::string text = folder.file("b.s");
    CHECK(run_puckloop("disasm " + first + " > " + text).status == 0);
    const std::string second = folder.file("second.hex");
    CHECK(run_puckloop("asm " + text + " -o " + second).status == 0);
    CHECK(content_of(first).size() > 60);
    CHECK(content_of(first) == content_of(second));
}

TEST_CASE("disasm prints address, words, text and branch targets") {
    const Folder folder;
    const std::string image = folder.file("x.hex");
    run_puckloop("asm " + folder.file("x.s", kSource) + " -o " + image);
    const Ran all = run_puckloop("disasm " + image);
    CHECK(all.output.find("goto      L_000100                      ; 000000: 040100 000000") !=
          std::string::npos);
    CHECK(all.output.find("bra       L_000104                      ; 000104: 37ffff") != std::string::npos);
    const Ran part = run_puckloop("disasm " + image + " --start 0x102 --end 102");
    CHECK(part.output.find("#0x1234") == std::string::npos);
    CHECK(part.output.find("; 000102: 801611") != std::string::npos);
    CHECK(part.output.find("000104") == std::string::npos);
    CHECK(run_puckloop("disasm --words fa0004,0x3f0000").output ==
          "lnk       #0x4                          ; 000000: fa0004\n"
          ".pword    0x3f0000                      ; 000002: 3f0000\n");
}

TEST_CASE("asm lists and reports") {
    const Folder folder;
    const Ran list = run_puckloop("asm " + folder.file("l.s", "x: call x\nnop\n") + " --format list");
    CHECK(list.output == "000000: 020000 000000      1  call x\n000004: 000000             2  nop\n");
    const Ran placed = run_puckloop("asm " + folder.file("o.s", ".org 0x200\nnop\n") + " --format list");
    CHECK(placed.output == "000200: 000000             2  nop\n");
    const std::string bad = folder.file("bad.s", "nop\n  mvo w0, w1\n");
    const Ran failed = run_puckloop("asm " + bad);
    CHECK(failed.status == 2);
    CHECK(failed.output == "puckloop: " + bad + ": line 2: unknown instruction \"mvo\" (expected mov?)\n");
}

TEST_CASE("Wrong use and bad input give status 2 and one line") {
    const Folder folder;
    const std::string damaged = folder.file("d.hex", ":0400000000010400F7\n");
    for (const std::string& arguments :
         {std::string("disasm"), std::string("disasm /no/such/file.hex"), std::string("disasm /"),
          "disasm " + damaged, std::string("disasm --words xyz"), std::string("asm"),
          std::string("asm /no/such/file.s"), std::string("asm - --mcu pic16 < /dev/null"),
          std::string("asm - < /dev/null")}) {
        const Ran result = run_puckloop(arguments);
        INFO(arguments << ": " << result.output);
        CHECK(result.status == 2);
        CHECK_FALSE(result.output.empty());
    }
    CHECK(run_puckloop("disasm " + damaged).output ==
          "puckloop: " + damaged +
              ": line 1: the file ends without an end-of-file record (expected :00000001FF as last line)\n");
    CHECK(run_puckloop("asm " + folder.file("n.s", "nop\n") + " -o /dev/full").status == 1);
}
