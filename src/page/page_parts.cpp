#include "page/page_parts.h"

// The linker makes an object of two files, with these names in it.
extern "C" {
extern const char _binary_page_template_html_start[];
extern const char _binary_page_template_html_end[];
extern const char _binary_page_three_js_start[];
extern const char _binary_page_three_js_end[];
}

namespace patchlight {

std::string_view page_template() { return {_binary_page_template_html_start, _binary_page_template_html_end}; }

std::string_view page_scripts() { return {_binary_page_three_js_start, _binary_page_three_js_end}; }

}  // namespace patchlight
