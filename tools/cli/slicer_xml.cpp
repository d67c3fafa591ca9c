// SPDX-License-Identifier: Apache-2.0
#include "tools/cli/slicer_xml.hpp"

#include <CLI/CLI.hpp>

#include "formats/drawing/markup.hpp"
#include "tools/cli/command.hpp"

namespace palpate::cli {
namespace {

using drawing::escaped;

std::string element(const std::string& name, const std::string& text) {
    return "      <" + name + ">" + escaped(text) + "</" + name + ">\n";
}

// Slicer passes every number and every default, whether somebody asked for them or not; so it may know none
// of those that do not go with everything else.
bool has_default(const CLI::Option& option) {
    return !option.get_default_str().empty() && option.get_needs().empty() && option.get_excludes().empty();
}

const char* tag_of(const Parameter& parameter) {
    const bool passed_only_if_filled_in = !has_default(parameter.option.handle());
    switch (parameter.kind) {
        case Parameter::Kind::input_file:
        case Parameter::Kind::output_file:
            return "file";
        case Parameter::Kind::number:
            return passed_only_if_filled_in ? "string" : "double";
        case Parameter::Kind::integer:
            return passed_only_if_filled_in ? "string" : "integer";
        case Parameter::Kind::flag:
            return "boolean";
        case Parameter::Kind::text:
            break;
    }
    return "string";
}

// In the order of CTK's schema, which is stricter than Slicer's parser. Slicer wants identifiers, for its
// flags as well: Command::parse() takes "--max_triangles" for "--max-triangles".
std::string parameter_xml(const Parameter& parameter, int& position) {
    const CLI::Option& option = parameter.option.handle();
    const std::string tag = tag_of(parameter);
    std::string xml = "    <" + tag + (option.get_expected_max() > 1 ? " multiple=\"true\"" : "") + ">\n";
    xml += element("name", identifier(option.get_single_name()));
    if (option.get_positional())
        xml += element("index", std::to_string(position++));
    else if (!option.get_lnames().empty())
        xml += element("longflag", "--" + identifier(option.get_lnames().front()));
    xml += element("description", parameter.help);
    xml += element("label", option.get_single_name());
    if (has_default(option)) xml += element("default", option.get_default_str());
    if (parameter.kind == Parameter::Kind::input_file) xml += element("channel", "input");
    if (parameter.kind == Parameter::Kind::output_file) xml += element("channel", "output");
    return xml + "    </" + tag + ">\n";
}

}  // namespace

std::string slicer_xml(const Command& command) {
    std::string xml = "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<executable>\n";
    xml += "  <category>Palpate</category>\n  <title>palpate " + escaped(command.text().name) + "</title>\n";
    xml += "  <description>" + escaped(command.text().summary) + "</description>\n";
    xml += "  <version>" + version() + "</version>\n  <license>see LICENSES</license>\n";
    xml += "  <contributor>The Palpate authors</contributor>\n";
    xml +=
        "  <parameters>\n    <label>Parameters</label>\n    <description>Files and settings; positions in "
        "LPS mm</description>\n";
    int position = 0;
    for (const Parameter& parameter : command.parameters()) xml += parameter_xml(parameter, position);
    return xml + "  </parameters>\n</executable>\n";
}

}  // namespace palpate::cli
