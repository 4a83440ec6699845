#pragma once
// Reports as HTML pages: one look for all of them, which is the live page's (view/page), light or dark as the
// browser is.

#include <string>
#include <string_view>

namespace puckloop {

/// All up to <body>, and that. `style`: CSS that only this page has.
std::string html_head(std::string_view title, std::string_view style = {});

}  // namespace puckloop
