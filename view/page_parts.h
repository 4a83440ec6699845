#pragma once
// The page, which is part of the program: the files of view/page, put together by cmake/EmbedPage.cmake.

#include <string_view>

namespace puckloop::view {

std::string_view page_html();
std::string_view page_script();
std::string_view page_style();

}  // namespace puckloop::view
