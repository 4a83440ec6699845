#include "traces/can_frames.h"
#include "traces/edges.h"
#include "traces/formats/export.h"

#include "base/error.h"
#include "protocols/serial/uart_sampling.h"
#include "traces/received.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <string>

namespace puckloop::tools {

namespace {

using cosim::Time;

const std::string kNoByte = "s ";

/// Short identifiers of characters with which neither a time nor a value nor a keyword begins: readers that
/// do not know strings skip them word by word.
std::string identifier(std::size_t n) {
    constexpr std::string_view kCharacters = "!%&()*+,./:;<=>?@[]^_{|}~";
    std::string text;
    do {
        text += kCharacters[n % kCharacters.size()];
        n /= kCharacters.size();
    } while (n != 0);
    return text;
}

/// Names must not hold blanks.
std::string word(const std::string& name) {
    std::string text = name.empty() ? "_" : name;
    std::replace_if(
        text.begin(), text.end(), [](char c) { return c <= ' '; }, '_');
    return text;
}

std::string binary(std::uint64_t value) {
    return fmt::format("b{:b} ", value);
}

/// As text: at a vector of several bits libsigrok 0.5.2 gives up the rest of the file.
std::string byte_text(unsigned value) {
    return fmt::format("s{:02x} ", value);
}

struct Variable {
    std::string scope, from, name, type;
    unsigned width = 1;
    std::string initial;
};

/// Variables that are no lines, and the changes of their values.
class Values {
  public:
    using Emit = std::function<void(Time, std::size_t variable, std::string value)>;
    explicit Values(Emit emit) : emit_(std::move(emit)) {}

    void add(const cosim::TraceRow& row) {
        if (keeps_from_arriving(row.fault)) return;
        if (const auto* frame = std::get_if<cosim::UartFrame>(&row.payload)) {
            const std::size_t byte = variable(row, "byte", "string", 1, kNoByte);
            emit_(frame->start, byte, byte_text(frame->is_break ? 0U : frame->data));
            emit_(protocols::frame_end(*frame), byte, kNoByte);
        } else if (const auto* phase = std::get_if<cosim::I2cPhase>(&row.payload)) {
            add_phase(row, *phase);
        } else if (const auto* signal = std::get_if<cosim::Signal>(&row.payload)) {
            const std::string name = row.signal.empty() ? fmt::format("signal{}", signal->id) : row.signal;
            emit_(row.time, variable(row, name, "real", 64, "r0 "), fmt::format("r{} ", signal->value));
        } else if (const auto* radio = radio_on_air(row)) {
            const std::size_t octets = variable(row, "octets", "string", 1, "s ");
            emit_(radio->start, octets, fmt::format("s{} ", hex_of(radio->octets)));
            emit_(radio->start + radio->duration, octets, "s ");
        } else if (const auto can = can_on_bus(row)) {
            const std::size_t text = variable(can->bus, "", "frame", "string", 1, "s ");
            emit_(can->start, text, fmt::format("s{} ", can->text()));
            emit_(can->end(), text, "s ");
        }
        if (row.fault == cosim::FaultKind::None) return;
        emit_(row.time, variable(row, "fault_kind", "string", 1, "s "),
              fmt::format("s{} ", fault_name(row.fault)));
    }

    void add(const FaultMark& mark) {
        emit_(mark.time, variable(mark.place, "", "fault_kind", "string", 1, "s "),
              fmt::format("s{} ", mark.kind));
    }

    const std::vector<Variable>& variables() const { return variables_; }

  private:
    void add_phase(const cosim::TraceRow& row, const cosim::I2cPhase& phase) {
        static constexpr std::string_view kNames[] = {"start", "write", "read", "stop",
                                                      "ack",   "data",  "lost"};
        std::string_view name = kNames[static_cast<std::size_t>(phase.kind)];
        if (phase.kind == cosim::I2cPhaseKind::Acknowledge && phase.ack == 0) name = "nack";
        emit_(row.time, variable(row, "phase", "string", 1, "s "), fmt::format("s{} ", name));
        emit_(row.time, variable(row, "byte", "string", 1, kNoByte), byte_text(phase.byte));
    }

    std::size_t variable(const cosim::TraceRow& row, const std::string& name, const std::string& type,
                         unsigned width, const std::string& initial) {
        return variable(row.link, row.from, name, type, width, initial);
    }
    std::size_t variable(const std::string& scope, const std::string& from, const std::string& name,
                         const std::string& type, unsigned width, const std::string& initial) {
        const auto [found, is_new] =
            index_.try_emplace(fmt::format("{}\n{}\n{}", scope, from, name), variables_.size());
        if (is_new) variables_.push_back({scope, from, name, type, width, initial});
        return found->second;
    }

    Emit emit_;
    std::vector<Variable> variables_;
    std::map<std::string, std::size_t> index_;
};

/// Pins are among the values already.
bool is_drawn(const Line& line) {
    return line.kind != Line::Kind::Pin;
}

struct Unit {
    const char* name;
    Time length;
};
constexpr std::array<Unit, 7> kUnits{{{"1 us", cosim::kMicrosecond},
                                      {"100 ns", 100 * cosim::kNanosecond},
                                      {"10 ns", 10 * cosim::kNanosecond},
                                      {"1 ns", cosim::kNanosecond},
                                      {"100 ps", 100},
                                      {"10 ps", 10},
                                      {"1 ps", 1}}};

/// The coarsest in which a bit, or the clock of a bus, has sixteen: sigrok makes a sample of each.
Unit fitting_unit(Time shortest_bit) {
    constexpr Time kUnitsOfBit = 16;
    const auto fits = [&](const Unit& unit) { return unit.length <= shortest_bit / kUnitsOfBit; };
    const auto found = std::find_if(kUnits.begin(), kUnits.end(), fits);
    return found != kUnits.end() ? *found : kUnits.back();
}

Unit unit_named(const std::string& name) {
    for (const Unit& unit : kUnits)
        if (name == unit.name) return unit;
    throw InputError("", "--timescale", fmt::format("'{}' is no unit", name),
                     "1 us, 100 ns, 10 ns, 1 ns, 100 ps, 10 ps or 1 ps");
}

void declare(std::ostream& out, const std::vector<Variable>& variables, const Unit& unit) {
    out << "$version puckloop $end\n$timescale " << unit.name << " $end\n";
    std::map<std::pair<std::string, std::string>, std::vector<std::size_t>> scopes;
    for (std::size_t n = 0; n < variables.size(); ++n)
        scopes[{variables[n].scope, variables[n].from}].push_back(n);
    for (const auto& [scope, members] : scopes) {
        const bool inner = !scope.second.empty();
        out << "$scope module " << word(scope.first) << " $end\n";
        if (inner) out << "$scope module " << word(scope.second) << " $end\n";
        for (const std::size_t n : members)
            out << "$var " << variables[n].type << ' ' << variables[n].width << ' ' << identifier(n) << ' '
                << word(variables[n].name) << " $end\n";
        out << (inner ? "$upscope $end\n$upscope $end\n" : "$upscope $end\n");
    }
    // With the time: libsigrok begins at the first one, and would not see a line leave its idle level there.
    out << "$enddefinitions $end\n#0\n$dumpvars\n";
    for (std::size_t n = 0; n < variables.size(); ++n)
        out << variables[n].initial << identifier(n) << '\n';
    out << "$end\n";
}

struct Change {
    std::size_t variable = 0;
    std::string value;
};

void write_vcd(const RecordedTrace& trace, std::ostream& out, VcdValues* others,
               const std::string& timescale);

}  // namespace

void export_vcd(const RecordedTrace& trace, std::ostream& out, const std::string& timescale) {
    write_vcd(trace, out, nullptr, timescale);
}

void export_vcd_with(const RecordedTrace& trace, std::ostream& out, VcdValues& others) {
    write_vcd(trace, out, &others, "1 ps");
}

namespace {

void write_vcd(const RecordedTrace& trace, std::ostream& out, VcdValues* others,
               const std::string& timescale) {
    // First pass: which variables there are, and how late their changes become known.
    Time now = 0, late = 0;
    Values found([&](Time time, std::size_t, const std::string&) { late = std::max(late, now - time); });
    const FaultMarks marks(trace);
    LineRenderer lines([](Time, const LineEvent&) {}, marks);
    FaultMarkCursor surveyed_marks(marks, FaultMarkCursor::All);
    trace.for_each_checked([&](const cosim::TraceRow& row) {
        while (const FaultMark* mark = surveyed_marks.next(row.time))
            found.add(*mark);
        now = row.time;
        found.add(row);
        lines.add(row);
    });
    while (const FaultMark* mark = surveyed_marks.next(cosim::kNever))
        found.add(*mark);
    lines.end();
    const LineSurvey surveyed{lines.lines(), lines.how_late(), lines.last(), lines.shortest_bit()};
    std::vector<Variable> variables;
    // sigrok names wires without their scopes: the names of the sigrok session are unique.
    for (const Line& line : surveyed.lines)
        variables.push_back(
            {line.scope, line.from, line.full_name(), "wire", 1, line.rests_high() ? "1" : "0"});
    const std::size_t values_from = variables.size();
    variables.insert(variables.end(), found.variables().begin(), found.variables().end());
    const std::size_t others_from = variables.size();
    if (others != nullptr)
        for (const VcdValues::Variable& one : others->variables())
            variables.push_back({one.scope, "", one.name, one.bits == 1 ? "wire" : "reg", one.bits, "bx "});
    // Pins have their signal's variable; theirs is not declared.
    std::vector<Variable> declared;
    std::vector<std::size_t> place(variables.size());
    for (std::size_t n = 0; n < variables.size(); ++n) {
        place[n] = declared.size();
        if (n >= values_from || is_drawn(surveyed.lines[n])) declared.push_back(variables[n]);
    }
    const Unit unit = timescale.empty() ? fitting_unit(surveyed.shortest_bit) : unit_named(timescale);
    declare(out, declared, unit);

    ReorderBuffer<Change> buffer;
    Time written = 0;
    const auto write_until = [&](Time end) {
        while (!buffer.empty() && buffer.first() < end) {
            const Time time = buffer.first() / unit.length;
            const Change change = buffer.pop();
            if (time != written) out << '#' << time << '\n';
            written = time;
            out << change.value << identifier(place[change.variable]) << '\n';
        }
    };
    Values values([&](Time time, std::size_t variable, std::string value) {
        buffer.push(std::max<Time>(time, 0), {values_from + variable, std::move(value)});
    });
    std::optional<VcdValues::Change> other = others != nullptr ? others->next() : std::nullopt;
    const auto others_until = [&](Time end) {
        // Piece by piece: in a long silence of the lines there may be millions.
        while (other && other->time < end) {
            const Time piece = std::min(end, other->time + cosim::kMillisecond);
            for (; other && other->time < piece; other = others->next())
                buffer.push(other->time, {others_from + other->variable, binary(other->value)});
            write_until(piece);
        }
    };
    EdgeStream edges(trace, marks, surveyed);
    std::optional<Edges> next = edges.next();
    const auto edges_until = [&](Time end) {
        for (; next && next->time < end; next = edges.next())
            for (const auto& [line, level] : next->levels)
                if (is_drawn(surveyed.lines[line])) buffer.push(next->time, {line, level ? "1" : "0"});
    };
    RecordedTrace::Cursor cursor(trace);
    FaultMarkCursor next_mark(marks, FaultMarkCursor::All);
    while (const auto row = cursor.next()) {
        while (const FaultMark* mark = next_mark.next(row->time))
            values.add(*mark);
        values.add(*row);
        edges_until(row->time - late);
        others_until(row->time - late);
        write_until(row->time - late);
    }
    while (const FaultMark* mark = next_mark.next(cosim::kNever))
        values.add(*mark);
    edges_until(cosim::kNever);
    others_until(cosim::kNever);
    write_until(cosim::kNever);
}

}  // namespace

}  // namespace puckloop::tools
