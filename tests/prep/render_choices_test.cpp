// Choices of a picture, and the names of enums: one table each, and no word is taken for another.
#include "prep/render_choices.h"

#include <gtest/gtest.h>

#include <iterator>
#include <set>
#include <tuple>

#include "prep/material.h"
#include "prep/prepare.h"
#include "prep/tangent_conventions.h"

namespace {

using prep::RenderChoices;
using prep::RenderWishes;

template <class E>
void expect_names() {
    std::set<std::string_view> names;
    std::set<int> values;
    for (const auto& [name, value] : names_of(E{})) {
        EXPECT_TRUE(names.insert(name).second) << name;
        EXPECT_TRUE(values.insert(static_cast<int>(value)).second) << name;
        EXPECT_EQ(prep::name_of(value), name);
        const prep::Result<E> read = prep::enum_named<E>(name);
        ASSERT_TRUE(read) << name;
        EXPECT_EQ(*read, value) << name;
    }
    // Every value from 0 on has its name.
    EXPECT_EQ(*values.rbegin() + 1, static_cast<int>(values.size()));
    for (const char* unknown : {"", "Flat", "none of them", "flat "}) {
        const prep::Result<E> read = prep::enum_named<E>(unknown);
        ASSERT_FALSE(read) << unknown;
        EXPECT_EQ(read.error().code, prep::ErrorCode::invalid);
        EXPECT_EQ(read.error().text,
                  "'" + std::string(unknown) + "' is not one of " + prep::names_text<E>());
    }
}

TEST(EnumNames, LeadThereAndBackAndOthersAreErrors) {
    expect_names<prep::Shading>();
    expect_names<prep::Cull>();
    expect_names<prep::TextureFilter>();
    expect_names<prep::Coverage>();
    expect_names<prep::DepthFormat>();
    expect_names<prep::ToneMap>();
    expect_names<prep::Wrap>();
    expect_names<prep::Filter>();
    expect_names<prep::MipFilter>();
    expect_names<prep::AlphaMode>();
    expect_names<prep::NormalMapSpace>();
    expect_names<prep::LightKind>();
    expect_names<prep::NormalWeight>();
    expect_names<prep::Precision>();
    expect_names<prep::Authored>();
    expect_names<prep::WeldMode>();
    expect_names<prep::Severity>();
    expect_names<prep::PlaceKind>();
    expect_names<prep::TangentMethod>();
    expect_names<prep::TangentSign>();
    expect_names<prep::GreenDirection>();
}

TEST(EnumNames, AreListedInTheirOrder) {
    EXPECT_EQ(prep::names_text<prep::Shading>(), "flat|gouraud|phong|normal-mapped");
    EXPECT_EQ(prep::names_text<prep::Coverage>(", "), "samples, area");
}

TEST(RenderChoices, WishesChangeWhatTheyGiveAndNothingElse) {
    // Every choice at a value that is not its default.
    RenderWishes all;
    all.choices = {320,
                   200,
                   prep::Shading::flat,
                   glm::vec3(0.5f),
                   prep::Cull::none,
                   prep::TextureFilter::ewa,
                   4,
                   2,
                   prep::Coverage::area,
                   prep::DepthFormat::fixed16,
                   16,
                   prep::ToneMap::reinhard,
                   2.5f,
                   0.5f};
    const auto members = [](const RenderChoices& c) {
        return std::tuple(c.width, c.height, c.shading, c.background.x, c.cull, c.filter, c.samples,
                          c.supersample, c.coverage, c.depth_format, c.max_anisotropy, c.tone_map,
                          c.exposure, c.allow_error);
    };
    EXPECT_EQ(members(with_wishes({}, all)), members({}));  // none is given
    std::set<std::string_view> keys;
    prep::for_each_render_choice(
        [&](std::string_view key, auto, const auto&, const char*) { keys.insert(key); });
    EXPECT_EQ(keys.size(), 13u);
    for (const std::string_view key : keys) {
        all.given = {key};
        EXPECT_NE(members(with_wishes({}, all)), members({})) << key;
        all.given = keys;
        all.given.erase(key);
        EXPECT_NE(members(with_wishes({}, all)), members(all.choices)) << key;
    }
    all.given = keys;
    EXPECT_EQ(members(with_wishes({}, all)), members(all.choices));
}

TEST(RenderChoices, HexColoursAreDecoded) {
    const std::optional<glm::vec3> color = prep::color_from_hex("#fF000A");
    ASSERT_TRUE(color);
    EXPECT_EQ(color->r, 1);
    EXPECT_EQ(color->g, 0);
    EXPECT_NEAR(color->b, 10 / 255.0 / 12.92, 1e-9);
    for (const char* wrong :
         {"", "#", "#12345", "#1234567", "123456", "#12345g", "#+12345", "#-1-1-1", "# 12345"})
        EXPECT_FALSE(prep::color_from_hex(wrong)) << wrong;
}

TEST(MaterialMaps, AreInTheOrderOfTheirKindsWithThoseThatAreDrawnFirst) {
    bool drawn = true;
    std::set<std::string_view> names;
    for (std::size_t i = 0; i < std::size(prep::material_maps); ++i) {
        const prep::MaterialMap& map = prep::material_maps[i];
        EXPECT_EQ(std::size_t(map.kind), i);
        EXPECT_TRUE(names.insert(map.name).second) << map.name;
        EXPECT_TRUE(drawn || map.use == prep::MapUse::not_drawn) << map.name;
        drawn = map.use != prep::MapUse::not_drawn;
        prep::Material material;
        (material.*map.ref).texture = 7;
        for (const prep::MaterialMap& other : prep::material_maps)
            EXPECT_EQ(bool(material.*other.ref), other.kind == map.kind) << map.name;
    }
}

}  // namespace
