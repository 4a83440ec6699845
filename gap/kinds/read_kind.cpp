#include "gap/kinds/read_kind.h"

#include "base/enum_names.h"
#include "base/error.h"
#include "base/text/suggest.h"
#include "base/text/toml_file.h"
#include "gap/kinds/legal_values.h"
#include "physics/description/parameters.h"
#include "scenarios/values/reader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

namespace puckloop::gap {

namespace {

using scenarios::Dimension;
using scenarios::Reader;

constexpr std::size_t kMost = 64;  // columns, parameters, formulas, effects
constexpr std::size_t kMostObservables = 8;
constexpr std::size_t kLongestText = 300;  // characters
constexpr std::uintmax_t kLargestFile = 1 << 20;
constexpr double kMostThings = 63;  // that an index column numbers
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr const char* kNameRemedy =
    "a letter, then letters, digits and _, at most 40, and no function of formulas";
constexpr std::array<std::string_view, 4> kRoleNames{"observable", "truth", "stimulus", "covariate"};
constexpr std::array<std::string_view, 3> kNoiseNames{"carry", "level", "event"};
// Words before the point of parameters that are no simulator's parameter but known to an overlay.
constexpr std::array<std::string_view, 4> kTaken{"command", "host", "timing", "uart"};

struct Entry {
    std::string name;
    const TomlValue* value;
};

/// A table's entries as they are in the file.
std::vector<Entry> in_file_order(const TomlTable& table) {
    std::vector<Entry> entries;
    for (const auto& [name, value] : table)
        entries.push_back({name, &value});
    std::ranges::stable_sort(entries, {}, [](const Entry& one) { return one.value->line; });
    return entries;
}

bool is_taken(const std::string& kind) {
    if (is_builtin_kind(kind) || std::ranges::find(kTaken, kind) != kTaken.end()) return true;
    return std::ranges::any_of(physics::parameter_table(), [&](const auto& parameter) {
        return std::string_view(parameter.name).starts_with(kind + ".");
    });
}

/// Reads one file into one description.
class KindFile {
  public:
    explicit KindFile(const std::filesystem::path& path) : file_(path.string()), root_(read()) {
        kind_.file = path;
    }

    Description description() {
        Reader top(file_, "", root_);
        read_head(top);
        const auto columns = entries(top, "column", true);
        const auto parameters = entries(top, "parameter", false);
        const auto formulas = entries(top, "formula", false);
        const auto effects = entries(top, "effect", true);
        top.finish();
        for (const Entry& one : columns)
            read_column(one);
        add_common();
        for (const Entry& one : parameters)
            read_parameter(one);
        check_chain(top);
        read_named_formulas(formulas);
        for (const Entry& one : columns)
            read_observable(one);
        check_observables(top);
        check_use();
        for (const Entry& one : effects)
            read_effect(one);
        check_legal_values(kind_);
        return std::move(kind_);
    }

  private:
    TomlValue read() const {
        constexpr const char* kRemedy = "the file of a kind, as docs/gap_kinds.md has it";
        std::error_code failed;
        if (!std::filesystem::exists(file_, failed)) throw InputError(file_, "", "is not there", kRemedy);
        if (!std::filesystem::is_regular_file(file_, failed))
            throw InputError(file_, "", "is no file", kRemedy);
        if (std::filesystem::file_size(file_, failed) > kLargestFile)
            throw InputError(file_, "", "is larger than 1 MB", kRemedy);
        return read_toml(file_);
    }

    [[noreturn]] void fail(int line, const std::string& problem, const std::string& expected) const {
        throw InputError(file_, fmt::format("line {}", line), problem, expected);
    }

    const char* keep(std::string text) { return kind_.texts.emplace_back(std::move(text)).c_str(); }

    /// One line that can be printed.
    std::string line_of(Reader& reader, const char* key, const std::string& text) {
        if (text.size() > kLongestText)
            reader.fail(key, fmt::format("{} has {} characters", key, text.size()),
                        fmt::format("at most {}", kLongestText));
        if (std::ranges::any_of(text, [](unsigned char c) { return c < 0x20 || c == 0x7f; }))
            reader.fail(key, fmt::format("{} holds a control character", key), "one line of text");
        return text;
    }
    std::string said(Reader& reader, const char* key) { return line_of(reader, key, reader.text(key)); }
    std::string said(Reader& reader, const char* key, const char* otherwise) {
        return line_of(reader, key, reader.text(key, otherwise));
    }

    double number(Reader& reader, const char* key, double otherwise) {
        const double value = reader.quantity(key, Dimension::Number, otherwise);
        if (reader.has(key) && !std::isfinite(value))
            reader.fail(key, fmt::format("{} is not finite", key), "a finite number");
        return value;
    }

    std::pair<double, double> range(Reader& reader) {
        const auto ends = reader.quantities("range", Dimension::Number, 2);
        if (!std::isfinite(ends[0]) || !std::isfinite(ends[1]))
            reader.fail("range", "range is not finite", "two finite numbers");
        if (!(ends[0] < ends[1]))
            reader.fail("range", fmt::format("range goes from {:g} to {:g}", ends[0], ends[1]),
                        "the smaller end first, and not the same twice");
        return {ends[0], ends[1]};
    }

    void read_head(Reader& top) {
        kind_.name = top.text("name");
        if (!is_variable_name(kind_.name))
            top.fail("name", "name is no name that parameters can begin with", kNameRemedy);
        if (is_taken(kind_.name))
            top.fail("name", fmt::format("name is \"{}\", which the simulator has", kind_.name),
                     "another name");
        kind_.title = said(top, "title", "");
        kind_.chain = top.text("chain", "");
    }

    std::vector<Entry> entries(Reader& top, const char* key, bool needed) {
        const TomlValue* table = top.table(key);
        if (table == nullptr) {
            if (needed) top.fail_missing(key, fmt::format("at least one [{}.NAME]", key));
            return {};
        }
        auto all = in_file_order(std::get<TomlTable>(table->data));
        if (all.size() > kMost)
            fail(table->line, fmt::format("there are {} entries of {}", all.size(), key),
                 fmt::format("at most {}", kMost));
        return all;
    }

    const TomlValue& table_of(const Entry& entry, const char* what) const {
        if (!entry.value->is_table())
            fail(entry.value->line, fmt::format("{} {} is no table", what, entry.name),
                 fmt::format("[{}.{}]", what, entry.name));
        return *entry.value;
    }

    /// A new name among all variables.
    void take_name(const std::string& name, const char* what, int line) {
        if (!is_variable_name(name))
            fail(line, fmt::format("{} \"{}\" is no variable that a formula can have", what, name),
                 kNameRemedy);
        const auto [first, fresh] = taken_.emplace(name, fmt::format("{}, line {}", what, line));
        if (!fresh)
            fail(line, fmt::format("{} {} has a name that is there already ({})", what, name, first->second),
                 "each name once among columns, parameters and formulas");
    }

    void read_column(const Entry& entry) {
        Reader reader(file_, "column " + entry.name, table_of(entry, "column"));
        take_name(entry.name, "column", entry.value->line);
        ColumnInfo column{};
        column.name = keep(entry.name);
        column.role =
            *value_named<Role>(kRoleNames, reader.choice("role", "", {kRoleNames.begin(), kRoleNames.end()}));
        const std::string unit = reader.text("unit");
        if (!is_column_unit(unit)) {
            std::vector<std::string_view> known;
            for (const std::string_view si : kBaseUnits)
                known.push_back(si);
            reader.fail("unit", fmt::format("unit \"{}\" of column {} is not known", unit, entry.name),
                        fmt::format("{} (files may have others of these: [columns] of experiment.toml)",
                                    fmt::join(known, ", ")));
        }
        column.unit = keep(unit);
        std::tie(column.low, column.high) = range(reader);
        column.meaning = keep(said(reader, "meaning", ""));
        column.index = reader.flag("index", false);
        const bool measured = column.role == Role::Observable;
        column.required = measured && reader.flag("required", true);
        if (column.index && (measured || column.low < 0 || column.high > kMostThings))
            reader.fail("index", fmt::format("index of column {} does not fit", entry.name),
                        fmt::format("a column that is set up, with a range within 0 to {:g}", kMostThings));
        if (reader.has("default")) {
            const double absent = number(reader, "default", 0.0);
            if (measured) reader.fail("default", "a measured column has no default", "no default");
            if (absent < column.low || absent > column.high)
                reader.fail("default", fmt::format("default {:g} is outside the range", absent),
                            fmt::format("{:g} to {:g}", column.low, column.high));
            kind_.absent[kind_.columns.size()] = absent;
        }
        if (measured)  // the rest of it is read when all names are known
            for (const char* key :
                 {"mean", "noise", "noise_factor", "noise_sd", "floor", "ceiling", "quantum"})
                (void)reader.has(key);
        reader.finish();
        kind_.columns.push_back(column);
    }

    void add_common() {
        kind_.own_columns = kind_.columns.size();
        for (const ColumnInfo& column : common_columns())
            if (taken_.emplace(column.name, "column of all kinds").second) kind_.columns.push_back(column);
    }

    void check_chain(Reader& top) const {
        if (kind_.chain.empty()) return;
        const ColumnInfo* chain = own_column(kind_.chain);
        if (chain == nullptr || !chain->index)
            top.fail("chain", fmt::format("chain is \"{}\", which is no index column", kind_.chain),
                     "a column with index = true, whose values are series of their own");
    }

    const ColumnInfo* own_column(const std::string& name) const {
        const auto place = kind_.column(name);
        return place ? &kind_.columns[*place] : nullptr;
    }

    void read_parameter(const Entry& entry) {
        Reader reader(file_, "parameter " + entry.name, table_of(entry, "parameter"));
        take_name(entry.name, "parameter", entry.value->line);
        DescribedParameter parameter;
        parameter.name = entry.name;
        parameter.line = entry.value->line;
        parameter.unit = said(reader, "unit", "1");
        (void)reader.quantity("neutral", Dimension::Number);  // must be there
        parameter.neutral = parameter.low = parameter.high = number(reader, "neutral", 0.0);
        parameter.per = reader.text("per", "");
        if (!parameter.per.empty()) {
            const ColumnInfo* things = own_column(parameter.per);
            if (things == nullptr || !things->index)
                reader.fail("per", fmt::format("per is \"{}\", which is no index column", parameter.per),
                            "a column with index = true");
        }
        Freed freed;
        freed.line = entry.value->line;
        if (reader.has("range")) {
            std::tie(parameter.low, parameter.high) = range(reader);
            if (parameter.neutral < parameter.low || parameter.neutral > parameter.high)
                reader.fail("neutral", fmt::format("neutral {:g} is outside the range", parameter.neutral),
                            fmt::format("{:g} to {:g}", parameter.low, parameter.high));
            freed.prior_sd = number(reader, "prior_sd", (parameter.high - parameter.low) / 4);
            if (!(freed.prior_sd > 0)) reader.fail("prior_sd", "prior_sd is not above 0", "a width above 0");
        } else if (reader.has("prior_sd")) {
            reader.fail("prior_sd", "prior_sd without a range", "range = [low, high] as well");
        }
        freed.source = said(reader, "source", "stated by the kind's user");
        freed.starts = reader.bare_numbers("starts");
        for (const double start : freed.starts)
            if (!(start >= parameter.low && start <= parameter.high))
                reader.fail("starts", fmt::format("start {:g} is outside the range", start),
                            fmt::format("{:g} to {:g}", parameter.low, parameter.high));
        reader.finish();
        freed_.push_back(std::move(freed));
        // "gain3" would be taken for one of "gain", which each sensor has.
        for (const DescribedParameter& other : kind_.parameters)
            if ((!other.per.empty() && is_numbered(parameter.name, other.name)) ||
                (!parameter.per.empty() && is_numbered(other.name, parameter.name)))
                fail(parameter.line,
                     fmt::format("parameters {} and {} would be confused", other.name, parameter.name),
                     "no digits at the end of one of the names");
        kind_.parameters.push_back(std::move(parameter));
    }

    static bool is_numbered(std::string_view name, std::string_view group) {
        return name.size() > group.size() && name.starts_with(group) &&
               name.find_first_not_of("0123456789", group.size()) == std::string_view::npos;
    }

    Formula formula_of(const std::string& what, const std::string& text, int line) const {
        try {
            Formula formula(text, kind_.variables());
            for (const std::size_t index : formula.used())
                if (const auto [variable, place] = kind_.variable(index);
                    variable == Description::Variable::Column &&
                    kind_.columns[place].role == Role::Observable)
                    fail(line, fmt::format("{} has {}, which is measured", what, kind_.columns[place].name),
                         "what was set up, is true or was noted");
            return formula;
        } catch (const FormulaError& error) {
            fail(line, fmt::format("{} {}", what, error.what()), error.expected());
        }
    }

    void read_named_formulas(const std::vector<Entry>& entries) {
        for (const Entry& one : entries) {
            take_name(one.name, "formula", one.value->line);
            if (!one.value->is_string())
                fail(one.value->line, fmt::format("formula {} is no text", one.name), "\"a formula\"");
        }
        // Compiled twice: to find what each has, then in an order in which each comes after what it has.
        compile(entries);
        std::vector<Entry> sorted;
        std::vector<char> state(entries.size(), 0);  // 1: being visited, 2: done
        for (std::size_t f = 0; f < entries.size(); ++f)
            visit(f, entries, state, sorted);
        compile(sorted);
        kind_.named_formulas = sorted.size();
    }

    void compile(const std::vector<Entry>& order) {
        kind_.formulas.clear();
        kind_.formula_names.clear();
        for (const Entry& one : order)
            kind_.formula_names.push_back(one.name);
        for (const Entry& one : order) {
            const std::string what = "formula " + one.name;
            kind_.formulas.push_back(
                {what, formula_of(what, std::get<std::string>(one.value->data), one.value->line),
                 one.value->line});
        }
    }

    void visit(std::size_t f, const std::vector<Entry>& order, std::vector<char>& state,
               std::vector<Entry>& sorted) const {
        if (state[f] == 2) return;
        if (state[f] == 1)
            fail(order[f].value->line, fmt::format("formula {} has itself in it, in a circle", order[f].name),
                 "formulas that have only others than themselves");
        state[f] = 1;
        for (const std::size_t index : kind_.formulas[f].formula.used())
            if (const auto [what, place] = kind_.variable(index); what == Description::Variable::Formula)
                visit(place, order, state, sorted);
        state[f] = 2;
        sorted.push_back(order[f]);
    }

    void read_observable(const Entry& entry) {
        const std::size_t column = *kind_.column(entry.name);
        if (kind_.columns[column].role != Role::Observable) return;
        Reader reader(file_, "column " + entry.name, *entry.value);
        DescribedObservable observable;
        observable.column = column;
        observable.noise = *value_named<NoiseKind>(
            kNoiseNames, reader.choice("noise", "carry", {kNoiseNames.begin(), kNoiseNames.end()}));
        observable.mean = add_formula(reader, "mean", entry.name, reader.text("mean"));
        for (const auto& [key, place] :
             {std::pair("noise_factor", &observable.factor), std::pair("noise_sd", &observable.sd)}) {
            if (!reader.has(key)) continue;
            if (observable.noise == NoiseKind::Event)
                reader.fail(key, fmt::format("{} of an event", key), "noise = \"carry\" or \"level\"");
            *place = add_formula(reader, key, entry.name, reader.text(key));
        }
        observable.instrument = {number(reader, "floor", kNone), number(reader, "ceiling", kNone),
                                 number(reader, "quantum", 0.0)};
        const Instrument& ends = observable.instrument;
        if (ends.floor >= ends.ceiling || ends.quantum < 0)
            reader.fail("floor", "floor, ceiling and quantum do not fit",
                        "floor below ceiling, quantum not negative");
        if (observable.noise == NoiseKind::Event &&
            (kind_.columns[column].low != 0 || kind_.columns[column].high != 1))
            reader.fail("range", "range of an event", "[0, 1]");
        kind_.observables.push_back(observable);
    }

    std::size_t add_formula(Reader& reader, const char* key, const std::string& column,
                            const std::string& text) {
        const std::string what = fmt::format("{} of {}", key, column);
        const int line = reader.line_of(key);
        kind_.formulas.push_back({what, formula_of(what, text, line), line});
        return kind_.formulas.size() - 1;
    }

    void check_observables(Reader& top) {
        if (kind_.observables.empty())
            top.fail("column", "no column has the role \"observable\"", "one that is measured");
        if (kind_.observables.size() > kMostObservables)
            top.fail("column", fmt::format("{} columns are observables", kind_.observables.size()),
                     fmt::format("at most {}", kMostObservables));
    }

    /// What formulas have must be there; what nobody has is a mistake.
    void check_use() {
        std::set<std::size_t> used;
        for (std::size_t f = kind_.named_formulas; f < kind_.formulas.size(); ++f)
            for (const std::size_t index : kind_.all_used(f))
                used.insert(index);
        const std::size_t first_parameter = kind_.columns.size(),
                          first_formula = first_parameter + kind_.parameters.size();
        for (std::size_t f = 0; f < kind_.named_formulas; ++f)
            if (!used.contains(first_formula + f))
                fail(kind_.formulas[f].line,
                     fmt::format("{} is in no observable's formula", kind_.formulas[f].what),
                     "a use of it, or no such formula");
        for (std::size_t p = 0; p < kind_.parameters.size(); ++p)
            if (!used.contains(first_parameter + p))
                fail(kind_.parameters[p].line,
                     fmt::format("parameter {} is in no observable's formula", kind_.parameters[p].name),
                     "a use of it, or no such parameter");
        for (std::size_t c = 0; c < kind_.columns.size(); ++c)
            if (used.contains(c) && !kind_.absent.contains(c)) kind_.columns[c].required = true;
        for (const DescribedParameter& parameter : kind_.parameters)
            if (!parameter.per.empty()) {
                const std::size_t c = *kind_.column(parameter.per);
                if (!kind_.absent.contains(c)) kind_.columns[c].required = true;
            }
    }

    void read_effect(const Entry& entry) {
        Reader reader(file_, "effect " + entry.name, table_of(entry, "effect"));
        if (!is_variable_name(entry.name))
            fail(entry.value->line, fmt::format("effect \"{}\" is no name", entry.name), kNameRemedy);
        Effect effect{};
        effect.name = keep(entry.name);
        effect.number = static_cast<int>(kind_.effects.size()) + 1;
        effect.title = keep(said(reader, "title"));
        effect.enters = keep("the formulas of " + kind_.name);
        effect.separated_by = keep(said(reader, "separated_by"));
        if (reader.has("mistaken_for")) effect.mistaken = keep(said(reader, "mistaken_for"));
        for (const std::string& need : reader.texts("needs")) {
            if (own_column(need) == nullptr)
                reader.fail("needs",
                            fmt::format("needs \"{}\", which is no column of this kind{}", need,
                                        did_you_mean(need, column_names())),
                            "columns that must be there and vary");
            effect.needs.push_back(keep(need));
        }
        const auto names = reader.texts("parameters");
        if (names.empty()) reader.fail("parameters", "no parameters", "those that the effect moves");
        std::set<std::string> once;
        for (const std::string& name : names) {
            if (!once.insert(name).second)
                reader.fail("parameters", fmt::format("parameter {} is named twice", name), "each once");
            effect.parameters.push_back(freed_parameter(reader, name));
        }
        effect.role = moves_scatter(names) ? EffectRole::Scatter : EffectRole::Mean;
        effect.kinds = {Kind::Described};
        reader.finish();
        kind_.effects.push_back(std::move(effect));
    }

    EffectParameter freed_parameter(Reader& reader, const std::string& name) {
        for (std::size_t p = 0; p < kind_.parameters.size(); ++p) {
            const DescribedParameter& own = kind_.parameters[p];
            if (own.name != name) continue;
            if (!(own.high > own.low))
                reader.fail("parameters",
                            fmt::format("parameter {} has no range, line {}", name, freed_[p].line),
                            "range = [low, high] for what an effect moves");
            EffectParameter freed{};
            freed.name = keep(kind_.full_name(own) + (own.per.empty() ? "" : "*"));
            freed.low = own.low;
            freed.high = own.high;
            freed.prior_sd = freed_[p].prior_sd;
            freed.source = keep(freed_[p].source);
            freed.starts = freed_[p].starts;
            return freed;
        }
        std::vector<std::string_view> known;
        for (const DescribedParameter& own : kind_.parameters)
            known.emplace_back(own.name);
        reader.fail("parameters",
                    fmt::format("\"{}\" is no parameter of this kind{}", name, did_you_mean(name, known)),
                    "names of [parameter.NAME]");
    }

    bool moves_scatter(const std::vector<std::string>& names) const {
        for (const DescribedObservable& observable : kind_.observables)
            for (const auto scatter : {observable.factor, observable.sd}) {
                if (!scatter) continue;
                for (const std::size_t index : kind_.all_used(*scatter))
                    if (const auto [what, place] = kind_.variable(index);
                        what == Description::Variable::Parameter &&
                        std::ranges::find(names, kind_.parameters[place].name) != names.end())
                        return true;
            }
        return false;
    }

    std::vector<std::string_view> column_names() const {
        std::vector<std::string_view> names;
        for (const ColumnInfo& column : kind_.columns)
            names.emplace_back(column.name);
        return names;
    }

    /// What an effect needs to know of a parameter.
    struct Freed {
        double prior_sd = 0.0;
        std::string source;
        std::vector<double> starts;
        int line = 0;
    };
    static constexpr std::array<std::string_view, 21> kBaseUnits{
        "1",    "counts", "m",   "rad", "s",   "V", "degC", "Hz", "m/s", "rad/s", "steps/s",
        "m/s2", "kg",     "1/m", "A",   "ohm", "W", "N",    "Pa", "T",   "lx"};

    std::string file_;
    TomlValue root_;
    Description kind_;
    std::map<std::string, std::string> taken_;  // names, and what has them
    std::vector<Freed> freed_;                  // of each parameter
};

}  // namespace

Kind read_kind(const std::filesystem::path& file) {
    return Kind(std::make_shared<const Description>(KindFile(file).description()));
}

bool names_kind_file(std::string_view text) {
    return text.ends_with(".toml");
}

Kind kind_stated(const std::string& text, const std::filesystem::path& folder, std::string_view file,
                 std::string_view place) {
    return names_kind_file(text) ? read_kind(folder / text) : kind_named(text, file, place);
}

}  // namespace puckloop::gap
