#include "metier/path_evaluation/drawing.hpp"

#include <gmock/gmock.h>

#include <pugixml.hpp>

namespace metier::path_evaluation {
namespace {

using ::testing::HasSubstr;

DrawnPath onePath(std::string name) {
    DrawnPath path;
    path.name = std::move(name);
    for (std::size_t i = 0; i <= kCorners; ++i) {
        path.positions.push_back(path.square.corner(i).translation);
    }
    path.measurement = {0.0000123, 0.0000045};
    return path;
}

pugi::xml_document parsed(const std::string& svg) {
    pugi::xml_document document;
    EXPECT_TRUE(document.load_string(svg.c_str()));
    return document;
}

TEST(DrawSvg, HasOnePanelForEachPath) {
    const std::vector<DrawnPath> paths{onePath("UR5"), onePath("e.DO")};
    const auto document = parsed(drawSvg(paths));
    EXPECT_EQ(document.select_nodes("//*[@class='title']").size(), 2U);
    EXPECT_EQ(document.select_nodes("//*[@class='measured']").size(), 2U);
    EXPECT_EQ(document.select_nodes("//*[@class='deviation']").size(), 2U);
}

TEST(DrawSvg, DrawsThePathOntoItsSquare) {
    const std::vector<DrawnPath> paths{onePath("UR5")};
    const auto document = parsed(drawSvg(paths));
    const std::string ideal =
        document.select_node("//*[@class='ideal']").node().attribute("points").value();
    const std::string measured =
        document.select_node("//*[@class='measured']").node().attribute("points").value();
    EXPECT_THAT(measured, ::testing::StartsWith(ideal));
}

TEST(DrawSvg, WritesFiguresInMillimetres) {
    const std::vector<DrawnPath> paths{onePath("UR5")};
    EXPECT_THAT(drawSvg(paths), HasSubstr("deviation 0.0123 mm, closure 0.0045 mm"));
}

TEST(DrawSvg, EscapesNamesAndSurvivesEmptyPaths) {
    const std::vector<DrawnPath> paths{{"<a & \"b\">", Square{}, {}, {}}};
    const auto document = parsed(drawSvg(paths));
    EXPECT_STREQ(document.select_node("//*[@class='title']").node().text().get(), "<a & \"b\">");
}

}  // namespace
}  // namespace metier::path_evaluation
