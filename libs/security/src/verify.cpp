#include <fmt/format.h>

#include <fstream>
#include <utility>

#include "chain.hpp"
#include "metier/security/audit_log.hpp"
#include "parts.hpp"

namespace metier::security {
namespace {

/// Follows the chain from line to line.
class Chain {
public:
    explicit Chain(const std::set<std::string>& anchors) : anchors_(anchors) {
        note(verified_.last_chain);
    }

    Result<void> take(std::istream& lines, const std::filesystem::path& file) {
        std::uint64_t number = 0;
        for (std::string text; std::getline(lines, text);) {
            ++number;
            if (std::exchange(at_begin_, false)) {
                begin(text);
            }
            const bool whole = !lines.eof();  // the end of the line was read, too
            const auto line = readLine(text, verified_.last_chain);
            if (!whole || !line || line->number != verified_.first_number + verified_.entries) {
                return fail(Errc::invalid_argument,
                            fmt::format("{}:{}: is not as it was written, or the line before is "
                                        "missing",
                                        file.string(), number));
            }
            add(*line);
        }
        at_begin_ = false;
        return {};
    }
    const Verified& verified() const noexcept { return verified_; }

private:
    /// Begins with a part that is checked without the part before it.
    void begin(std::string_view text) {
        const auto line = readLastLine(text);
        const bool continued = line && !line->after.empty();
        verified_.first_number = continued ? line->number : 1;
        verified_.last_chain = continued ? line->after : std::string(kNoChain);
        note(verified_.last_chain);
    }
    void note(const std::string& chain) {
        if (anchors_.contains(chain)) {
            verified_.anchors.insert(chain);
        }
    }
    void add(const ReadLine& line) {
        ++verified_.entries;
        verified_.last_chain = line.chain;
        verified_.last_time = line.time;
        note(line.chain);
        if (verified_.first_time.empty()) {
            verified_.first_time = line.time;
        }
    }

    const std::set<std::string>& anchors_;
    bool at_begin_ = true;
    Verified verified_{.last_chain = std::string(kNoChain)};
};

}  // namespace

std::vector<std::filesystem::path> partsOf(const std::filesystem::path& file) {
    std::vector<std::filesystem::path> parts;
    const auto last = lastPart(file);
    for (std::uint32_t number = 1; number <= last; ++number) {
        parts.push_back(partOf(file, number));
    }
    return parts;
}

Result<Verified> verify(const std::filesystem::path& file, const std::set<std::string>& anchors) {
    Chain chain(anchors);
    for (const auto& part : partsOf(file)) {
        std::ifstream lines(part);
        if (!lines) {
            return fail(Errc::not_found, fmt::format("{} cannot be read", part.string()));
        }
        METIER_TRY(chain.take(lines, part));
    }
    return chain.verified();
}

}  // namespace metier::security
