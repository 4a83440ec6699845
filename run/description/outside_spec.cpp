#include "run/description/outside_spec.h"

#include "base/error.h"
#include "base/fields/json.h"
#include "run/files/program_path.h"

#include <fmt/format.h>

#include <filesystem>

namespace puckloop::tools {

exec::UartSpec parse_outside(const std::string& place, const std::string& text, const std::string& folder) {
    exec::UartSpec spec = exec::parse_uart_spec(place, text);
    if (spec.kind == exec::UartSpec::Kind::Stdio)
        throw InputError("", place, "a run has no standard input to give", "pty, tcp:PORT or script:FILE");
    if (!spec.file.empty()) spec.file = full_path(std::filesystem::path(folder) / spec.file).string();
    return spec;
}

JsonValue UartEndForm::write(const exec::UartSpec& end) {
    switch (end.kind) {
    case exec::UartSpec::Kind::Script:
        return "script:" + end.file;
    case exec::UartSpec::Kind::Tcp:
        return fmt::format("tcp:{}", end.port);
    case exec::UartSpec::Kind::Pty:
        return "pty";
    default:
        return "-";
    }
}

void UartEndForm::read(exec::UartSpec& end, const JsonValue& from, const std::string& place) {
    std::string text;
    from_value(text, from, place);
    end = exec::parse_uart_spec(place, text);
}

}  // namespace puckloop::tools
