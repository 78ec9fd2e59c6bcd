#include "nodeset_texts.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "bare_client.hpp"

namespace metier::opcua::testing {

std::string textOf(const NodesetText& nodeset) {
    std::string required;
    std::string uris;
    for (const auto& uri : nodeset.required) {
        required += fmt::format("\n      <RequiredModel ModelUri=\"{}\"/>", uri);
        uris += fmt::format("<Uri>{}</Uri>", uri);
    }
    return fmt::format(R"(<?xml version="1.0" encoding="utf-8"?>
<UANodeSet xmlns="http://opcfoundation.org/UA/2011/03/UANodeSet.xsd"
           xmlns:uax="http://opcfoundation.org/UA/2008/02/Types.xsd">
  <NamespaceUris><Uri>urn:test:{0}</Uri>{2}</NamespaceUris>
  <Models>
    <Model ModelUri="urn:test:{0}" Version="1.0">{1}
    </Model>
  </Models>
  <Aliases><Alias Alias="HasSubtype">i=45</Alias><Alias Alias="HasComponent">i=47</Alias>
    <Alias Alias="HasTypeDefinition">i=40</Alias><Alias Alias="Organizes">i=35</Alias>
    <Alias Alias="Double">i=11</Alias><Alias Alias="HasProperty">i=46</Alias></Aliases>
{3}
</UANodeSet>
)",
                       nodeset.model, required, uris, nodeset.nodes);
}

NodesetFolder::NodesetFolder() {
    auto name = (std::filesystem::path(::testing::TempDir()) / "nodesets-XXXXXX").string();
    EXPECT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
}

NodesetFolder::~NodesetFolder() {
    std::error_code error;
    std::filesystem::remove_all(folder_, error);
}

std::filesystem::path NodesetFolder::write(const std::string& name, std::string_view text) const {
    auto path = folder_ / name;
    std::ofstream(path, std::ios::binary) << text;
    return path;
}

std::filesystem::path NodesetFolder::write(const NodesetText& nodeset) const {
    return write(nodeset.model + ".xml", textOf(nodeset));
}

Result<std::unique_ptr<Server>> serverWith(const std::vector<std::filesystem::path>& files) {
    auto options = testOptions();
    options.nodeset_files = files;
    return Server::create(std::move(options));
}

}  // namespace metier::opcua::testing
