#include <algorithm>
#include <array>
#include <cctype>

#include "metier/records/store.hpp"

namespace metier::records {
namespace {

std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

bool fitsText(const Execution& e, const std::string& text) {
    if (text.empty() || e.id == text) {
        return true;
    }
    std::string names;
    for (const auto* name : {&e.server, &e.server_name, &e.controller, &e.skill, &e.device, &e.user,
                             &e.state, &e.reason}) {
        names += *name + ' ';
    }
    names.pop_back();
    const auto wanted = lower(text);
    return lower(names).find(wanted) != std::string::npos ||
           lower(e.reason_text).find(wanted) != std::string::npos;
}

}  // namespace

bool fits(const Execution& e, const Filter& filter) {
    const std::array<std::pair<const std::string*, const std::string*>, 5> equal{
        {{&filter.skill, &e.skill},
         {&filter.state, &e.state},
         {&filter.reason, &e.reason},
         {&filter.user, &e.user},
         {&filter.parent, &e.parent}}};
    return std::all_of(equal.begin(), equal.end(),
                       [](const auto& pair) {
                           return pair.first->empty() || *pair.first == *pair.second;
                       }) &&
           (filter.server.empty() || filter.server == e.server || filter.server == e.server_name) &&
           (!filter.from || e.started >= *filter.from) &&
           (!filter.until || e.started < *filter.until) && fitsText(e, filter.text);
}

}  // namespace metier::records
