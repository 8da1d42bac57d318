// Bundled workflows.
