#include "base/pages/svg.h"

#include <fmt/format.h>

namespace puckloop {

std::string escaped(std::string_view text) {
    std::string out;
    for (const char c : text) {
        if (c == '<')
            out += "&lt;";
        else if (c == '>')
            out += "&gt;";
        else if (c == '&')
            out += "&amp;";
        else if (c == '"')
            out += "&quot;";
        else
            out += c;
    }
    return out;
}

std::string svg_text(double x, double y, std::string_view text, std::string_view style) {
    return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" {}>{}</text>\n", x, y, style, escaped(text));
}

std::string svg_line(double x1, double y1, double x2, double y2, std::string_view style) {
    return fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" {}/>\n", x1, y1, x2, y2,
                       style);
}

std::string svg_moved(double x, double y, std::string_view svg) {
    return fmt::format("<g transform=\"translate({:.0f},{:.0f})\">{}</g>\n", x, y, svg);
}

std::string svg_document(double width, double height, int font_size, std::string_view body) {
    return fmt::format("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} {1:.0f}\" "
                       "width=\"{0:.0f}\" height=\"{1:.0f}\" font-family=\"DejaVu Sans, Helvetica, Arial, "
                       "sans-serif\" font-size=\"{2}\" fill=\"#333333\">\n"
                       "<rect width=\"{0:.0f}\" height=\"{1:.0f}\" fill=\"#ffffff\"/>\n{3}</svg>\n",
                       width, height, font_size, body);
}

}  // namespace puckloop
