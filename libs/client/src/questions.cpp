#include "questions.hpp"

#include <utility>

namespace metier::client {

using opcua::Answer;

Answer<> Questions::next() {
    if (left_-- > 0 && std::chrono::steady_clock::now() < end_) {
        return {};
    }
    return tl::unexpected(
        failureOf(Errc::timeout, "the server goes on telling of more than anybody would look at"));
}

Answer<std::vector<opcua::Reference>> Questions::browse(opcua::BrowseQuery query) {
    METIER_TRY(next());
    return client_.browse(std::move(query));
}

Answer<opcua::Value> Questions::read(const opcua::NodeId& node, opcua::AttributeId attribute) {
    METIER_TRY(next());
    return client_.read(node, attribute);
}

Answer<std::vector<opcua::DataValue>> Questions::readMany(std::vector<opcua::ReadItem> items) {
    METIER_TRY(next());
    return client_.readMany(std::move(items));
}

}  // namespace metier::client
