#pragma once
// The JSON library (nlohmann) for those who use its values themselves. Its templates are compiled once, in
// json.cpp: each file that reads, writes and copies values compiled them again, an eighth of all code of a
// build.

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace puckloop::detail {

/// What `parse()` reads: a string or a view, a literal.
using JsonText = nlohmann::detail::iterator_input_adapter<std::string::const_iterator>;
using JsonLiteral = nlohmann::detail::iterator_input_adapter<const char*>;

}  // namespace puckloop::detail

// `extern` here, nothing in json.cpp. A class does not bring its member templates.
#define PUCKLOOP_JSON_BUILDER(WHERE, INPUT, ...)                                                             \
    WHERE template bool nlohmann::detail::parser<__VA_ARGS__, INPUT>::sax_parse_internal(                    \
        nlohmann::detail::json_sax_dom_parser<__VA_ARGS__>*);                                                \
    WHERE template bool nlohmann::detail::parser<__VA_ARGS__, INPUT>::sax_parse_internal(                    \
        nlohmann::detail::json_sax_dom_callback_parser<__VA_ARGS__>*);
#define PUCKLOOP_JSON_READER(WHERE, INPUT, ...)                                                              \
    WHERE template class nlohmann::detail::lexer<__VA_ARGS__, INPUT>;                                        \
    WHERE template class nlohmann::detail::parser<__VA_ARGS__, INPUT>;                                       \
    PUCKLOOP_JSON_BUILDER(WHERE, INPUT, __VA_ARGS__)
#define PUCKLOOP_JSON_VALUE(WHERE, ...)                                                                      \
    WHERE template class nlohmann::__VA_ARGS__;                                                              \
    WHERE template class std::vector<nlohmann::__VA_ARGS__>;                                                 \
    WHERE template class nlohmann::detail::serializer<nlohmann::__VA_ARGS__>;                                \
    WHERE template class nlohmann::detail::json_sax_dom_parser<nlohmann::__VA_ARGS__>;                       \
    WHERE template class nlohmann::detail::json_sax_dom_callback_parser<nlohmann::__VA_ARGS__>;              \
    PUCKLOOP_JSON_READER(WHERE, puckloop::detail::JsonText, nlohmann::__VA_ARGS__)                           \
    PUCKLOOP_JSON_READER(WHERE, puckloop::detail::JsonLiteral, nlohmann::__VA_ARGS__)
// Objects sorted by key, and in the order of writing.
#define PUCKLOOP_JSON(WHERE)                                                                                 \
    PUCKLOOP_JSON_VALUE(WHERE, basic_json<>)                                                                 \
    PUCKLOOP_JSON_VALUE(WHERE, basic_json<nlohmann::ordered_map>)                                            \
    WHERE template class std::map<std::string, nlohmann::json, std::less<>>;

PUCKLOOP_JSON(extern)
