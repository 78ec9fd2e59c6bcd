#include "holdings.hpp"

#include <algorithm>

namespace metier::security {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostFiles = 1'000;
// Two changes within one tick of the file system's clock have the same time.
constexpr auto kTick = std::chrono::seconds(1);
constexpr std::array kFolders{kTrusted, kTrustedLists, kIssuers, kIssuersLists};

std::vector<fs::path> allFilesIn(const fs::path& folder) {
    std::vector<fs::path> files;
    std::error_code error;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
         entry.increment(error)) {
        if (entry->is_regular_file(error)) {
            files.push_back(entry->path());
        }
    }
    return files;
}

std::vector<CrlPtr> listsIn(const fs::path& folder) {
    std::vector<CrlPtr> lists;
    for (const auto& file : filesIn(folder)) {
        if (auto list = parseCrlPemOrDer(readFile(file.string()))) {
            lists.push_back(std::move(list));
        }
    }
    return lists;
}

std::array<fs::file_time_type, 4> changesOf(const fs::path& folder) {
    std::array<fs::file_time_type, 4> times;
    std::transform(kFolders.begin(), kFolders.end(), times.begin(), [&](const char* part) {
        std::error_code error;
        const auto time = fs::last_write_time(folder / part, error);
        return error ? fs::file_time_type::min() : time;
    });
    return times;
}

}  // namespace

std::vector<fs::path> filesIn(const fs::path& folder) {
    auto files = allFilesIn(folder);
    std::sort(files.begin(), files.end());
    files.resize(std::min(files.size(), kMostFiles));
    return files;
}

void makeRoom(const fs::path& folder, std::size_t most) {
    std::vector<std::pair<fs::file_time_type, fs::path>> all;
    std::error_code gone;
    for (const auto& file : allFilesIn(folder)) {
        all.emplace_back(fs::last_write_time(file, gone), file);
    }
    std::sort(all.begin(), all.end());
    for (std::size_t i = 0; i + most <= all.size(); ++i) {
        fs::remove(all[i].second, gone);
    }
}

std::vector<Certificate> certificatesIn(const fs::path& folder) {
    std::vector<Certificate> found;
    for (const auto& file : filesIn(folder)) {
        if (auto certificate = Certificate::fromFile(file)) {
            found.push_back(std::move(*certificate));
        }
    }
    return found;
}

TrustStore::Holdings::Holdings(const fs::path& where)
    : folder(where),
      changed(changesOf(where)),
      looked(fs::file_time_type::clock::now()),
      trusted(certificatesIn(where / kTrusted)),
      issuers(certificatesIn(where / kIssuers)),
      lists(listsIn(where / kTrustedLists)) {
    for (auto& list : listsIn(where / kIssuersLists)) {
        lists.push_back(std::move(list));
    }
}

bool TrustStore::Holdings::isCurrent() const {
    const bool long_ago = std::all_of(changed.begin(), changed.end(),
                                      [&](auto time) { return time < looked - kTick; });
    return long_ago && changesOf(folder) == changed;
}

bool TrustStore::Holdings::trusts(const Certificate& certificate) const {
    return std::find(trusted.begin(), trusted.end(), certificate) != trusted.end();
}

bool TrustStore::Holdings::trustsOneOf(const STACK_OF(X509) * chain) const {
    for (int i = 0; i < sk_X509_num(chain); ++i) {
        const auto certificate = Certificate::fromDer(derOf(sk_X509_value(chain, i)));
        if (certificate && trusts(*certificate)) {
            return true;
        }
    }
    return false;
}

}  // namespace metier::security
