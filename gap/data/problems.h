#pragma once
// What is wrong with an experiment, gathered: `puckloop gap check` lists all of it, an analysis refuses the
// experiment for the first.

#include "base/error.h"

#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace puckloop::gap {

class Problems {
  public:
    /// The same fault in every row would bury the others: of a file this many are kept.
    static constexpr std::size_t kMostOfAFile = 6;

    /// Carries out one step of reading or checking. An InputError of it becomes a problem, and the result is
    /// false.
    template <class Step>
    bool attempt(const Step& step) {
        try {
            step();
            return true;
        } catch (const InputError& error) {
            if (++of_file_[error.file()] <= kMostOfAFile) errors_.push_back(error);
            return false;
        }
    }
    bool empty() const { return errors_.empty(); }
    const InputError& first() const { return errors_.front(); }
    /// One line each, as they were met; then one for each file that had more.
    std::vector<std::string> lines() const {
        std::vector<std::string> all;
        for (const InputError& error : errors_)
            all.emplace_back(error.what());
        for (const auto& [file, count] : of_file_)
            if (count > kMostOfAFile)
                all.push_back(file + ": and " + std::to_string(count - kMostOfAFile) + " more of this file");
        return all;
    }

  private:
    std::vector<InputError> errors_;
    std::map<std::string, std::size_t> of_file_;
};

}  // namespace puckloop::gap
