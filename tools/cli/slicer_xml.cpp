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

const char* tag_of(Parameter::Kind kind) {
    switch (kind) {
        case Parameter::Kind::input_file:
        case Parameter::Kind::output_file:
            return "file";
        case Parameter::Kind::number:
            return "double";
        case Parameter::Kind::integer:
            return "integer";
        case Parameter::Kind::flag:
            return "boolean";
        case Parameter::Kind::text:
            break;
    }
    return "string";
}

// Slicer wants identifiers; "--max-triangles" becomes "max_triangles".
std::string identifier(const CLI::Option& option) {
    std::string name = option.get_single_name();
    for (char& c : name)
        if (c == '-') c = '_';
    return name;
}

std::string parameter_xml(const Parameter& parameter, int& position) {
    const CLI::Option& option = parameter.option.handle();
    const std::string tag = tag_of(parameter.kind);
    std::string xml = "    <" + tag + (option.get_expected_max() > 1 ? " multiple=\"true\"" : "") + ">\n";
    xml += element("name", identifier(option));
    xml += element("label", option.get_single_name());
    xml += element("description", parameter.help);
    if (option.get_positional())
        xml += element("index", std::to_string(position++));
    else if (!option.get_lnames().empty())
        xml += element("longflag", "--" + option.get_lnames().front());
    if (parameter.kind == Parameter::Kind::input_file) xml += element("channel", "input");
    if (parameter.kind == Parameter::Kind::output_file) xml += element("channel", "output");
    if (!option.get_default_str().empty()) xml += element("default", option.get_default_str());
    return xml + "    </" + tag + ">\n";
}

}  // namespace

std::string slicer_xml(const Command& command) {
    std::string xml = "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<executable>\n";
    xml += "  <category>Palpate</category>\n  <title>palpate " + escaped(command.text().name) + "</title>\n";
    xml += "  <description>" + escaped(command.text().summary) + "</description>\n";
    xml += "  <version>" + version() + "</version>\n  <license>see LICENSES</license>\n";
    xml +=
        "  <parameters>\n    <label>Parameters</label>\n    <description>Files and settings; positions in "
        "LPS mm</description>\n";
    int position = 0;
    for (const Parameter& parameter : command.parameters()) xml += parameter_xml(parameter, position);
    return xml + "  </parameters>\n</executable>\n";
}

}  // namespace palpate::cli
