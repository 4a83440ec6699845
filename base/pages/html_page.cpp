#include "base/pages/html_page.h"

#include "base/pages/svg.h"

#include <fmt/format.h>

namespace puckloop {

namespace {

// The colours are those of view/page/page.css.
constexpr std::string_view kStyle = R"(
:root{color-scheme:light dark;--back:#fff;--part:#f4f5f7;--line:#d4d8de;--text:#1d2430;--strong:#005aa0}
@media (prefers-color-scheme:dark){:root{--back:#14181f;--part:#1b2029;--line:#323a47;--text:#e2e7ee;--strong:#6db5f0}}
body{font:14px/1.4 system-ui,"DejaVu Sans",sans-serif;margin:2em;background:var(--back);color:var(--text)}
h2{margin-top:1.6em} h3{margin:1.4em 0 .4em} a{color:var(--strong)}
table{border-collapse:collapse} td,th{border:1px solid var(--line);padding:2px 6px;text-align:left;vertical-align:top}
td.n{text-align:right} code,pre{background:var(--part);padding:1px 3px;overflow-wrap:anywhere} .wide{overflow-x:auto}
)";

}  // namespace

std::string html_head(std::string_view title, std::string_view style) {
    return fmt::format("<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
                       "<meta name=\"viewport\" content=\"width=device-width\">"
                       "<link rel=\"icon\" href=\"data:,\"><title>{}</title><style>{}{}"
                       "</style></head><body>\n",
                       escaped(title), kStyle, style);
}

}  // namespace puckloop
