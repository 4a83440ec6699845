#pragma once
// What is wrong with an experiment, gathered: `puckloop gap check` lists all of it, where reading for an
// analysis stops at the first.

#include "base/error.h"

#include <map>
#include <string>
#include <vector>

namespace puckloop::gap {

class Problems {
  public:
    /// The same fault in every row would bury the others: of a file this many are kept.
    static constexpr std::size_t kMostOfAFile = 6;

    void add(const InputError& error) {
        if (++of_file_[error.file()] <= kMostOfAFile) lines_.emplace_back(error.what());
    }
    bool empty() const { return lines_.empty(); }
    /// One line each, as they were met; then one for each file that had more.
    std::vector<std::string> lines() const {
        std::vector<std::string> all = lines_;
        for (const auto& [file, count] : of_file_)
            if (count > kMostOfAFile)
                all.push_back(file + ": and " + std::to_string(count - kMostOfAFile) + " more of this file");
        return all;
    }

  private:
    std::vector<std::string> lines_;
    std::map<std::string, std::size_t> of_file_;
};

/// Carries out one step of reading or checking. Where problems are gathered, an InputError of it becomes one
/// and the result is false; else (nullptr) it goes on to the caller.
template <class Step>
bool attempt(Problems* problems, const Step& step) {
    if (problems == nullptr) {
        step();
        return true;
    }
    try {
        step();
        return true;
    } catch (const InputError& error) {
        problems->add(error);
        return false;
    }
}

}  // namespace puckloop::gap
