"""The paper's tables and figures as a page: published beside ours, a file a section."""
