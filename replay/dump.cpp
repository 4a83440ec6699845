#include "replay/dump.h"

#include "traces/formats/export.h"

namespace puckloop::tools {

namespace {

class WatchedValues : public VcdValues {
  public:
    WatchedValues(const std::string& node, Watch& watch) : node_(node), watch_(watch) {
        watch.log().rewind();
    }

    std::vector<Variable> variables() const override {
        std::vector<Variable> variables;
        for (const Watch::Value& value : watch_.values())
            variables.push_back({node_, value.name, value.bits});
        return variables;
    }
    std::optional<Change> next() override {
        const auto change = watch_.log().next();
        if (!change) return std::nullopt;
        return Change{change->time, static_cast<std::size_t>(change->which), change->value};
    }

  private:
    const std::string& node_;
    Watch& watch_;
};

}  // namespace

void write_dump(const std::string& path, const RecordedTrace& lines, const std::string& node, Watch* watch) {
    write_output(path, [&](std::ostream& out) {
        if (watch == nullptr) return export_vcd(lines, out);
        WatchedValues values(node, *watch);
        export_vcd_with(lines, out, values);
    });
}

}  // namespace puckloop::tools
