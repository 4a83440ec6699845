#pragma once
// Pieces of SVG text. A style is a list of attributes, as it is.

#include <string>
#include <string_view>

namespace puckloop {

/// For the inside of SVG and HTML elements and of quoted attributes.
std::string escaped(std::string_view text);

std::string svg_text(double x, double y, std::string_view text, std::string_view style);
std::string svg_line(double x1, double y1, double x2, double y2, std::string_view style);
/// What stands in `svg`, moved right and down.
std::string svg_moved(double x, double y, std::string_view svg);

/// A picture of this size in pixels on white; `font_size` of texts that state none.
std::string svg_document(double width, double height, int font_size, std::string_view body);

}  // namespace puckloop
