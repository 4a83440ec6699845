#include "scenarios/reader/compose/include.h"

#include "base/error.h"
#include "scenarios/values/reader.h"

#include <fmt/format.h>

#include <algorithm>

namespace puckloop::scenarios {

namespace {

namespace fs = std::filesystem;

using Source = std::shared_ptr<const std::string>;

void mark(TomlValue& value, const Source& source) {
    value.source = source;
    if (auto* table = std::get_if<TomlTable>(&value.data))
        for (auto& entry : *table)
            mark(entry.second, source);
    if (auto* array = std::get_if<TomlArray>(&value.data))
        for (TomlValue& item : *array)
            mark(item, source);
}

bool is_list_of_tables(const TomlValue& value) {
    const auto* array = std::get_if<TomlArray>(&value.data);
    return array && !array->empty() &&
           std::all_of(array->begin(), array->end(), [](const TomlValue& item) { return item.is_table(); });
}

/// `over` on top of `under`.
void merge(TomlValue& under, TomlValue over) {
    auto* below = std::get_if<TomlTable>(&under.data);
    auto* above = std::get_if<TomlTable>(&over.data);
    if (below && above) {
        for (auto& [key, value] : *above) {
            const auto found = std::find_if(below->begin(), below->end(), [&, name = key](const auto& entry) {
                return entry.first == name;
            });
            if (found == below->end())
                below->emplace_back(key, std::move(value));
            else
                merge(found->second, std::move(value));
        }
        under.line = over.line;
        under.source = over.source;
        return;
    }
    if (is_list_of_tables(under) && is_list_of_tables(over)) {
        auto& list = std::get<TomlArray>(under.data);
        for (TomlValue& item : std::get<TomlArray>(over.data))
            list.push_back(std::move(item));
        return;
    }
    under = std::move(over);
}

class Including {
  public:
    explicit Including(std::vector<fs::path>& files) : files_(files) {}

    TomlValue read(const fs::path& file, bool first) {
        TomlValue own = read_toml(file);
        if (!first) mark(own, std::make_shared<const std::string>(file.string()));
        files_.push_back(file);
        std::error_code ignored;
        open_.push_back(fs::weakly_canonical(file, ignored));
        TomlValue all;
        all.data = TomlTable{};
        Reader reader(file.string(), "", own);
        for (const std::string& name : reader.texts("include")) {
            const fs::path included = file.parent_path() / name;
            if (std::find(open_.begin(), open_.end(), fs::weakly_canonical(included, ignored)) != open_.end())
                reader.fail("include", fmt::format("'{}' includes itself", included.string()),
                            "files that do not include each other in a ring");
            if (!fs::is_regular_file(included, ignored))
                reader.fail("include", fmt::format("there is no file '{}'", included.string()),
                            "a TOML file, relative to this one");
            constexpr std::size_t kMostFiles = 1000;
            if (files_.size() >= kMostFiles)
                reader.fail("include", "too many files are included", "at most 1000");
            merge(all, read(included, false));
        }
        std::erase_if(std::get<TomlTable>(own.data),
                      [](const auto& entry) { return entry.first == "include"; });
        merge(all, std::move(own));
        open_.pop_back();
        return all;
    }

  private:
    std::vector<fs::path>& files_;
    std::vector<fs::path> open_;  // those that include the present one
};

}  // namespace

TomlValue read_with_includes(const fs::path& file, std::vector<fs::path>& files) {
    return Including(files).read(file, true);
}

}  // namespace puckloop::scenarios
