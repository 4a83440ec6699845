#pragma once
// What is plugged into a UART from outside the robot: a script, a pseudo terminal, a TCP client.

#include "base/fields/field.h"
#include "base/fields/json_value.h"
#include "cosim/core/time.h"
#include "ends/uart_spec.h"

#include <string>
#include <string_view>

namespace puckloop::tools {

/// "pty", "tcp:PORT" or "script:FILE", a file's path counted from `folder`. Throws InputError naming `place`.
exec::UartSpec parse_outside(const std::string& place, const std::string& text, const std::string& folder);

struct UartEndForm {
    static JsonValue write(const exec::UartSpec& end);
    static void read(exec::UartSpec& end, const JsonValue& from, const std::string& place);
};

struct OutsideSpec {
    static constexpr std::string_view kKind = "outside";

    std::string name;
    exec::UartSpec end;
    double baud = 115200.0;
    std::string record;
    cosim::Time quiet = 0;

    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        return visit(
            field("name", &OutsideSpec::name, "of the node: \"robot0.uart1\"").required(),
            field("end", &OutsideSpec::end, "pty, tcp:PORT or script:FILE").required().as<UartEndForm>(),
            field("baud", &OutsideSpec::baud, "of the outside's own UART").in("baud").above(0),
            field("record", &OutsideSpec::record, "file for the bytes that came from the robot; empty: none"),
            field("quiet_ps", &OutsideSpec::quiet, "a live end is not listened to, and hears nothing, before")
                .in("ps")
                .not_in(Comparison::Run));
    }
};
static_assert(lists_all_fields<OutsideSpec>);

}  // namespace puckloop::tools
