#pragma once
// The folder that a run writes its results to: one run at a time, and nothing of an earlier one stays in it.

#include <filesystem>
#include <string>
#include <vector>

namespace puckloop::tools {

class ResultsFolder {
  public:
    /// Makes the folder, takes its lock and removes what the run before wrote there: that run left the names
    /// of its files in the lock file `.puckloop`, and nothing else is touched. `files` are the names that
    /// this run may write. InputError if another process holds the lock (it names that process), if one of
    /// `files` is a link or is there without a run's lock file, or if the folder or the lock cannot be made.
    ResultsFolder(const std::filesystem::path& folder, const std::vector<std::string>& files);
    /// Gives the lock back; the list stays for the next run. A run that is killed gives it back as well.
    ~ResultsFolder();
    ResultsFolder(const ResultsFolder&) = delete;
    ResultsFolder& operator=(const ResultsFolder&) = delete;

  private:
    void lock() const;
    std::string listed() const;
    void remove_listed() const;
    void list(const std::vector<std::string>& files) const;

    std::filesystem::path folder_, file_;
    int descriptor_ = -1;
};

}  // namespace puckloop::tools
