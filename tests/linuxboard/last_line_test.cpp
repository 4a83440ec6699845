#include "linuxboard/shim/node/last_line.h"

#include <catch2/catch.hpp>

using puckloop::linuxboard::last_line_with_text;

TEST_CASE("the last line with text is found behind colours and blank lines") {
    CHECK(last_line_with_text("") == "");
    CHECK(last_line_with_text("\n\n") == "");
    CHECK(last_line_with_text("one\ntwo") == "two");
    CHECK(last_line_with_text("one\ntwo\n") == "two");
    CHECK(last_line_with_text("[FATAL] no tty\n\x1b[0m\x1b[0m") == "[FATAL] no tty");
    CHECK(last_line_with_text("\x1b[1;31m[FATAL]\x1b[0m no tty\x1b[K\r\n \t \n\x1b[0m\n") ==
          "[FATAL] no tty");
    CHECK(last_line_with_text("10 %\r20 %\r\x1b[2K") == "20 %");
    CHECK(last_line_with_text("said\n\x1b]0;a title\x07\n") == "said");
    CHECK(last_line_with_text("said\n\x1b]0;a title\x1b\\\x1b(B\n") == "said");
    CHECK(last_line_with_text("a\tb\x07\n") == "a b");
    CHECK(last_line_with_text("gr\xc3\xb6\xc3\x9f"
                              "er\n") == "gr\xc3\xb6\xc3\x9f"
                                         "er");
    CHECK(last_line_with_text("cut \x1b[3") == "cut");
    CHECK(last_line_with_text("cut\x1b") == "cut");
}
