"""The workbench: a local web application over one project folder, `surae serve`."""
